// Properties that every generated track has, over seeds, characters, lengths and widths.
#include "slalom/vehicle/course/track_generator.hpp"

#include <limits>
#include <tuple>

#include "slalom/maps/distance_field.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom::vehicle {
namespace {

struct Case {
  const char* name;
  TrackCharacter character;
  double length, width;
};

void PrintTo(const Case& test, std::ostream* out) {
  *out << test.name;
}

/// A track of this case for each seed.
class TrackProperty : public ::testing::TestWithParam<std::tuple<Case, std::uint64_t>> {
 protected:
  static TrackGeneratorOptions options() {
    const auto& [test, seed] = GetParam();
    return {.seed = seed,
            .length = test.length,
            .width = test.width,
            .character = test.character,
            .limits = {.top_speed = usual_top_speed(test.character)}};
  }
  const TrackGeneratorOptions asked_ = options();
  const GeneratedTrack track_ = generate_track(asked_);
};

double cross(maps::Point a, maps::Point b, maps::Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool segments_cross(maps::Point a, maps::Point b, maps::Point c, maps::Point d) {
  return cross(a, b, c) * cross(a, b, d) < 0 && cross(c, d, a) * cross(c, d, b) < 0;
}

TEST_P(TrackProperty, CentreLineIsClosedSmoothAndAsLongAsAsked) {
  const auto& line = track_.centre_line;
  const std::size_t n = line.size();
  double length = 0, turning = 0, sharpest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const maps::Point a = line[(i + n - 2) % n], b = line[i], c = line[(i + 2) % n];
    const double step = distance(b, line[(i + 1) % n]);
    length += step;
    ASSERT_NEAR(step, 0.1, 0.02) << "row " << i << ": closed, and evenly spaced";
    const double bend = 2 * cross(a, b, c) / (distance(a, b) * distance(b, c) * distance(a, c));
    turning += bend * step;
    sharpest = std::max(sharpest, std::abs(bend));
  }
  EXPECT_NEAR(length, asked_.length, 1e-3 * asked_.length);
  EXPECT_NEAR(std::abs(turning), 2 * 3.14159265, 0.05) << "one turn in all";
  EXPECT_LE(sharpest, 1 / (0.5 * asked_.width + 0.45) + 1e-6);
}

TEST_P(TrackProperty, NeitherLineNorWallsIntersect) {
  const auto& line = track_.centre_line;
  const std::size_t n = line.size();
  const double apart = 3.15 * (0.5 * asked_.width + 0.45);
  const auto away = static_cast<std::size_t>(apart / asked_.length * static_cast<double>(n)) + 1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i + n - j >= 2) {
        ASSERT_FALSE(segments_cross(line[i], line[i + 1], line[j], line[(j + 1) % n]));
      }
      if (j - i >= away && i + n - j >= away) least = std::min(least, distance(line[i], line[j]));
    }
  EXPECT_GE(least, asked_.width + 2 * asked_.wall - 1e-9);
}

TEST_P(TrackProperty, RacelineKeepsItsLimits) {
  const SpeedLimits& limits = asked_.limits;
  const auto& rows = track_.raceline;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    SCOPED_TRACE(i);
    const auto &row = rows[i], &next = rows[(i + 1) % rows.size()];
    ASSERT_NEAR(std::hypot(row.x - next.x, row.y - next.y), 0.11, 0.02);
    ASSERT_GT(row.speed, 0.5);
    ASSERT_LE(row.speed, limits.top_speed);
    ASSERT_LE(row.speed * row.speed * std::abs(row.curvature), limits.lateral_acceleration + 1e-9);
    ASSERT_LE(row.acceleration, limits.acceleration + 1e-9);
    ASSERT_GE(row.acceleration, -limits.braking - 1e-9);
    // A 1/10 car's turning radius at full lock is 0.33 / tan(0.4189) = 0.741 m.
    ASSERT_LE(std::abs(row.curvature), 1 / 0.85);
  }
}

TEST_P(TrackProperty, EveryWaypointIsFreeWithTheMarginAndTheMapIsSealed) {
  const maps::OccupancyGrid& map = track_.map;
  const auto walls = maps::distance_transform(map, true);
  const auto clearance = [&](double x, double y) {
    const maps::Point at = maps::inverse_transform(map.origin, {x, y});
    return walls.at(static_cast<int>(at.x / map.resolution), static_cast<int>(at.y / map.resolution));
  };
  for (const auto& row : track_.raceline)
    ASSERT_GE(clearance(row.x, row.y), asked_.wall_margin - 2 * map.resolution);
  for (const auto& point : track_.obstacle_path) ASSERT_GE(clearance(point.x, point.y), 0.15);
  for (int row = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column) {
      if (map.at(column, row) != maps::Occupancy::free) continue;
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        ASSERT_TRUE(map.contains(column + dx, row + dy));
        ASSERT_NE(map.at(column + dx, row + dy), maps::Occupancy::unknown) << "a ray could leave the track";
      }
    }
}

TEST_P(TrackProperty, LoadsBackAsACourse) {
  const testing::ScopedFolder scoped;
  const auto folder = scoped.path() / "track";
  save_track(track_, folder, {"some \"name\"", "a description", "slalom track"});
  const Course course = load_course(folder);
  EXPECT_EQ(course.name, "some \"name\"");
  EXPECT_TRUE(course.closed);
  EXPECT_TRUE(course.notes.empty());
  EXPECT_EQ(course.waypoints.size(), track_.raceline.size());
  EXPECT_EQ(course.obstacle_path.size(), track_.obstacle_path.size());
  EXPECT_EQ(course.map.cells, track_.map.cells);
  EXPECT_NEAR(course.map.origin.x, track_.map.origin.x, 1e-9);
  EXPECT_NEAR(profile_time(course), track_.lap_time, 0.01 * track_.lap_time);
  EXPECT_NEAR(course.start.x, 0, 1e-4);
  for (std::size_t i = 0; i < course.waypoints.size(); ++i)
    ASSERT_NEAR(maps::wrap_angle(course.waypoints[i].yaw - track_.raceline[i].yaw), 0, 0.1) << "row " << i;
}

INSTANTIATE_TEST_SUITE_P(
    Tracks, TrackProperty,
    ::testing::Combine(::testing::Values(Case{"balanced", TrackCharacter::balanced, 60, 2.2},
                                         Case{"fast", TrackCharacter::fast, 90, 2.6},
                                         Case{"twisty", TrackCharacter::twisty, 75, 2.0},
                                         Case{"narrow", TrackCharacter::narrow, 50, 1.5},
                                         Case{"short", TrackCharacter::balanced, 21, 2.2},
                                         Case{"wide", TrackCharacter::twisty, 140, 5.0}),
                       ::testing::Range<std::uint64_t>(0, 3)),
    [](const auto& test) {
      return std::get<0>(test.param).name + ("_" + std::to_string(std::get<1>(test.param)));
    });

TEST(TrackGenerator, RepeatsForASeedAndDiffersBetweenSeeds) {
  TrackGeneratorOptions options{.seed = 7};
  const GeneratedTrack first = generate_track(options), again = generate_track(options);
  options.seed = 8;
  const GeneratedTrack other = generate_track(options);
  ASSERT_EQ(first.raceline.size(), again.raceline.size());
  for (std::size_t i = 0; i < first.raceline.size(); ++i) {
    ASSERT_EQ(first.raceline[i].x, again.raceline[i].x);
    ASSERT_EQ(first.raceline[i].speed, again.raceline[i].speed);
  }
  EXPECT_EQ(first.map.cells, again.map.cells);
  EXPECT_NE(first.map.cells, other.map.cells);
}

TEST(TrackGenerator, RejectsInvalidOptionsByName) {
  const auto refused = [](const char* key, auto&& change) {
    TrackGeneratorOptions options;
    change(options);
    const std::string message = message_of([&] { generate_track(options); });
    EXPECT_EQ(message.rfind(key, 0), 0u) << message;
  };
  refused("length", [](TrackGeneratorOptions& o) { o.length = 5; });
  refused("length", [](TrackGeneratorOptions& o) { o.length = 1e6; });
  refused("length", [](TrackGeneratorOptions& o) { o.length = std::nan(""); });
  refused("length", [](TrackGeneratorOptions& o) { o.length = 30, o.width = 4; });
  refused("width", [](TrackGeneratorOptions& o) { o.width = 0.4; });
  refused("width", [](TrackGeneratorOptions& o) { o.width = -2; });
  refused("width", [](TrackGeneratorOptions& o) { o.width = INFINITY; });
  refused("wall", [](TrackGeneratorOptions& o) { o.wall = 0; });
  refused("wall", [](TrackGeneratorOptions& o) { o.wall = 0.1, o.resolution = 0.08; });
  refused("wall_margin", [](TrackGeneratorOptions& o) { o.wall_margin = 1.05; });
  refused("resolution", [](TrackGeneratorOptions& o) { o.resolution = 1; });
  refused("top_speed", [](TrackGeneratorOptions& o) { o.limits.top_speed = 0; });
  refused("braking", [](TrackGeneratorOptions& o) { o.limits.braking = -3; });
  EXPECT_THROW(track_character("furious"), std::invalid_argument);
}

}  // namespace
}  // namespace slalom::vehicle
