// Properties that every generated track has, over seeds, characters, lengths and widths.
#include "slalom/vehicle/course/track_generator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

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

class TrackProperty : public ::testing::TestWithParam<Case> {
 protected:
  static TrackGeneratorOptions options(std::uint64_t seed) {
    TrackGeneratorOptions result;
    result.seed = seed;
    result.length = GetParam().length;
    result.width = GetParam().width;
    result.character = GetParam().character;
    result.limits.top_speed = usual_top_speed(result.character);
    return result;
  }
  static constexpr std::uint64_t seeds = 3;
};

double cross(maps::Point a, maps::Point b, maps::Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool segments_cross(maps::Point a, maps::Point b, maps::Point c, maps::Point d) {
  return cross(a, b, c) * cross(a, b, d) < 0 && cross(c, d, a) * cross(c, d, b) < 0;
}

double gap(maps::Point a, maps::Point b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

TEST_P(TrackProperty, CentreLineIsClosedSmoothAndAsLongAsAsked) {
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const TrackGeneratorOptions asked = options(seed);
    const auto line = generate_track(asked).centre_line;
    const std::size_t n = line.size();
    double length = 0, turning = 0, sharpest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const maps::Point a = line[(i + n - 2) % n], b = line[i], c = line[(i + 2) % n];
      const double step = gap(b, line[(i + 1) % n]);
      length += step;
      ASSERT_NEAR(step, 0.1, 0.02) << "seed " << seed << " row " << i << ": closed, and evenly spaced";
      const double bend = 2 * cross(a, b, c) / (gap(a, b) * gap(b, c) * gap(a, c));
      turning += bend * step;
      sharpest = std::max(sharpest, std::abs(bend));
    }
    EXPECT_NEAR(length, asked.length, 1e-3 * asked.length) << "seed " << seed;
    EXPECT_NEAR(std::abs(turning), 2 * 3.14159265, 0.05) << "seed " << seed << ": one turn in all";
    EXPECT_LE(sharpest, 1 / (0.5 * asked.width + 0.45) + 1e-6) << "seed " << seed;
  }
}

TEST_P(TrackProperty, NeitherLineNorWallsIntersect) {
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const TrackGeneratorOptions asked = options(seed);
    const auto line = generate_track(asked).centre_line;
    const std::size_t n = line.size();
    const double apart = 3.15 * (0.5 * asked.width + 0.45);
    const auto away = static_cast<std::size_t>(apart / asked.length * static_cast<double>(n)) + 1;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 2; j < n; ++j) {
        if (i + n - j >= 2) {
          ASSERT_FALSE(segments_cross(line[i], line[i + 1], line[j], line[(j + 1) % n])) << "seed " << seed;
        }
        if (j - i >= away && i + n - j >= away) least = std::min(least, gap(line[i], line[j]));
      }
    EXPECT_GE(least, asked.width + 2 * asked.wall - 1e-9) << "seed " << seed;
  }
}

TEST_P(TrackProperty, RacelineKeepsItsLimits) {
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const GeneratedTrack track = generate_track(options(seed));
    const SpeedLimits& limits = track.options.limits;
    const auto& rows = track.raceline;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto &row = rows[i], &next = rows[(i + 1) % rows.size()];
      ASSERT_NEAR(gap({row.x, row.y}, {next.x, next.y}), 0.11, 0.02) << "seed " << seed << " row " << i;
      ASSERT_GT(row.speed, 0.5);
      ASSERT_LE(row.speed, limits.top_speed);
      const double lateral = row.speed * row.speed * std::abs(row.curvature);
      ASSERT_LE(lateral, limits.lateral_acceleration + 1e-9) << "seed " << seed << " row " << i;
      ASSERT_LE(row.acceleration, limits.acceleration + 1e-9) << "seed " << seed << " row " << i;
      ASSERT_GE(row.acceleration, -limits.braking - 1e-9) << "seed " << seed << " row " << i;
      // A 1/10 car's turning radius at full lock is 0.33 / tan(0.4189) = 0.741 m.
      ASSERT_LE(std::abs(row.curvature), 1 / 0.85) << "seed " << seed << " row " << i;
    }
  }
}

TEST_P(TrackProperty, EveryWaypointIsFreeWithTheMarginAndTheMapIsSealed) {
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const GeneratedTrack track = generate_track(options(seed));
    const auto distance = maps::distance_transform(track.map, true);
    const auto clearance = [&](double x, double y) {
      const maps::Point at = maps::inverse_transform(track.map.origin, {x, y});
      return distance.at(static_cast<int>(at.x / track.map.resolution),
                         static_cast<int>(at.y / track.map.resolution));
    };
    for (const auto& row : track.raceline)
      ASSERT_GE(clearance(row.x, row.y), track.options.wall_margin - 2 * track.map.resolution)
          << "seed " << seed;
    for (const auto& point : track.obstacle_path)
      ASSERT_GE(clearance(point.x, point.y), 0.15) << "seed " << seed;
    for (int row = 0; row < track.map.height; ++row)
      for (int column = 0; column < track.map.width; ++column) {
        if (track.map.at(column, row) != maps::Occupancy::free) continue;
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
          ASSERT_TRUE(track.map.contains(column + dx, row + dy));
          ASSERT_NE(track.map.at(column + dx, row + dy), maps::Occupancy::unknown)
              << "a ray could leave the track";
        }
      }
  }
}

TEST_P(TrackProperty, LoadsBackAsACourse) {
  const GeneratedTrack track = generate_track(options(3));
  const testing::ScopedFolder scoped;
  const auto folder = scoped.path() / "track";
  save_track(track, folder, {"some \"name\"", "a description", "slalom track"});
  const Course course = load_course(folder);
  EXPECT_EQ(course.name, "some \"name\"");
  EXPECT_TRUE(course.closed);
  EXPECT_TRUE(course.notes.empty());
  EXPECT_EQ(course.waypoints.size(), track.raceline.size());
  EXPECT_EQ(course.obstacle_path.size(), track.obstacle_path.size());
  EXPECT_EQ(course.map.cells, track.map.cells);
  EXPECT_NEAR(course.map.origin.x, track.map.origin.x, 1e-9);
  EXPECT_NEAR(profile_time(course), track.lap_time, 0.01 * track.lap_time);
  EXPECT_NEAR(course.start.x, 0, 1e-4);
  for (std::size_t i = 0; i < course.waypoints.size(); ++i)
    ASSERT_NEAR(maps::wrap_angle(course.waypoints[i].yaw - track.raceline[i].yaw), 0, 0.1) << "row " << i;
}

INSTANTIATE_TEST_SUITE_P(Tracks, TrackProperty,
                         ::testing::Values(Case{"balanced", TrackCharacter::balanced, 60, 2.2},
                                           Case{"fast", TrackCharacter::fast, 90, 2.6},
                                           Case{"twisty", TrackCharacter::twisty, 75, 2.0},
                                           Case{"narrow", TrackCharacter::narrow, 50, 1.5},
                                           Case{"short", TrackCharacter::balanced, 21, 2.2},
                                           Case{"wide", TrackCharacter::twisty, 140, 5.0}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(TrackGenerator, RepeatsForASeedAndDiffersBetweenSeeds) {
  TrackGeneratorOptions options;
  options.seed = 7;
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
