// The world of the racing benchmark: its rules, its centre line, and the published laps of follow the gap.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "sim/golden_table.hpp"
#include "slalom/maps/ros_map.hpp"
#include "slalom/sim/follow_the_gap.hpp"
#include "slalom/sim/gym.hpp"
#include "slalom/sim/laps.hpp"
#include "slalom/sim/placement.hpp"
#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/sim/racing_benchmark.hpp"
#include "slalom/sim/shapes.hpp"

namespace slalom::sim {
namespace {

using namespace slalom::testing;

/// Columns x, y, half width of a file without header; the width is what f1tenth_gym takes for the speed.
std::vector<PathPoint> opponent_path(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<PathPoint> path;
  for (std::string line; std::getline(in, line);) {
    PathPoint p;
    char comma;
    std::istringstream cells(line);
    if (cells >> p.point.x >> comma >> p.point.y >> comma >> p.speed) path.push_back(p);
  }
  return path;
}

Box box_of(const GoldenRow& row, const std::string& suffix = "") {
  Box box{{row.real("x" + suffix), row.real("y" + suffix), row.real("yaw" + suffix)}, 0.58, 0.31};
  if (row.has("length")) box.length = row.real("length"), box.width = row.real("width");
  return box;
}

TEST(GymRules, PairCollisions) {
  compare_rows("gjk_pairs", 1e-9, [](const GoldenRow& row, Comparison& compared) {
    const double gap = signed_gap(box_of(row, "1"), box_of(row, "2"));
    EXPECT_EQ(gap <= 0, row.integer("collide") == 1) << "case " << row.text("case");
    compared.absolute(row, {{"sat_signed_gap", gap}});
  });
}

TEST(GymRules, NumpyDraws) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  std::ifstream in(folder / "rng_numpy.json");
  const auto json = nlohmann::json::parse(in);
  Comparison compared("rng_numpy");
  for (const auto& [seed_text, entry] : json.items()) {
    compared.next_case();
    const std::uint64_t seed = std::stoull(seed_text);
    const auto state = NumpyRandom::seed_state(seed);
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_EQ(std::to_string(state[i]), entry["seedseq_generate_state_uint64"][i].get<std::string>());
    NumpyRandom raw(seed);
    for (const auto& bits : entry["first6_uint64"])
      EXPECT_EQ(std::to_string(raw.bits()), bits.get<std::string>());
    NumpyRandom draws(seed);
    EXPECT_EQ(static_cast<int>(draws.below(1362)), entry["choice_of_1362"].get<int>());
    const auto real = [&values = entry](const char* key) {
      return std::stod(values[key].get<std::string>());
    };
    constexpr double pi = 3.141592653589793;
    compared.absolute(draws.uniform(0, 0.1), real("uniform_r"));
    compared.absolute(draws.uniform(-pi, pi), real("uniform_theta"));
    compared.absolute(draws.uniform(-pi, pi), real("uniform_yaw"));
  }
  EXPECT_GT(compared.cases(), 0);
  EXPECT_EQ(compared.worst(), 0);
}

TEST(GymRules, ScanNoise) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / "scan_noise_seed12345.csv");
  Comparison compared("scan_noise");
  NumpyRandom random(12345);
  for (const char* scan : {"noise_scan1", "noise_scan2"}) {
    compared.next_case();
    for (std::size_t row = 0; row < table.rows(); ++row)
      compared.absolute(0.01 * random.normal(), table[row].real(scan));
  }
  EXPECT_LE(compared.worst(), 1e-15);
}

TEST(GymRules, ParkedCars) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  std::vector<maps::Point> path;
  for (const PathPoint& p : opponent_path(folder / "maps/berlin/opp_ref_path.csv")) path.push_back(p.point);
  compare_rows("obstacles", 1e-12, [&](const GoldenRow& row, Comparison& compared) {
    const int index = row.integer("i");
    const auto cars = place_at_random(path, index + 1, static_cast<std::uint64_t>(row.integer("seed")));
    const maps::Pose& car = cars.at(index);
    compared.absolute(row, {{"x", car.x}, {"y", car.y}, {"yaw", car.yaw}});
  });
}

TEST(GymRules, PurePursuit) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const PurePursuit driver(opponent_path(folder / "maps/berlin/opp_ref_path.csv"), {.gym = true});
  compare_rows("pure_pursuit", 1e-9, [&](const GoldenRow& row, Comparison& compared) {
    const maps::Pose pose{row.real("x"), row.real("y"), row.real("yaw")};
    const auto target = driver.target({pose.x, pose.y});
    const Command command = driver.command(pose);
    using Mode = PurePursuit::Target::Mode;
    const char* mode = target.mode == Mode::lookahead   ? "lookahead"
                       : target.mode == Mode::reacquire ? "reacquire"
                                                        : "none";
    EXPECT_EQ(mode, row.text("mode"));
    EXPECT_EQ(static_cast<int>(target.nearest.segment), row.integer("nearest_seg"));
    EXPECT_EQ(target.row, row.integer("target_row")) << "case " << row.text("case");
    compared.absolute(row, {{"nearest_dist", target.nearest.distance},
                            {"nearest_t", target.nearest.along},
                            {"target_t", target.along},
                            {"speed", command.speed},
                            {"steer", command.steer}});
  });
}

TEST(GymRules, Laps) {
  std::vector<StartZoneLaps> cars;
  compare_rows("lap_trace", 0, [&](const GoldenRow& row, Comparison& compared) {
    const auto agent = static_cast<std::size_t>(row.integer("agent"));
    if (row.integer("k") == 0) {
      if (agent == 0) cars.clear();
      cars.emplace_back();
      const double heading = row.table[row.row - agent].real("start_yaw");
      cars[agent].reset({row.real("start_x"), row.real("start_y")}, heading);
    }
    StartZoneLaps& car = cars.at(agent);
    car.update({row.real("x"), row.real("y")}, row.real("time"));
    compared.absolute(row, {{"near_start", car.near_start()},
                            {"toggles", car.toggles()},
                            {"lap_count", car.laps()},
                            {"lap_time", car.time()},
                            {"checkpoint_done", car.finished()}});
  });
}

constexpr double pi = 3.14159265358979323846;

std::vector<maps::Point> ring(double radius, int count) {
  std::vector<maps::Point> points;
  for (int i = 0; i < count; ++i)
    points.push_back({radius * std::sin(2 * pi * i / count), radius - radius * std::cos(2 * pi * i / count)});
  return points;
}

/// A ring of radius 8 m and width 2 m through the origin, along +x there.
std::shared_ptr<const Track> ring_track() {
  maps::OccupancyGrid grid{400, 400, 0.05, {-10, -2, 0}, {}};
  for (int row = 0; row < grid.height; ++row)
    for (int column = 0; column < grid.width; ++column) {
      const double away = std::hypot(-10 + 0.05 * (column + 0.5), -10 + 0.05 * (row + 0.5));
      grid.cells.push_back(std::abs(away - 8) < 1 ? maps::Occupancy::free : maps::Occupancy::occupied);
    }
  return std::make_shared<const Track>(std::move(grid));
}

RacingBenchmark ring_world() {
  return {ring_track(), ring(8, 251)};
}

/// Drives round the ring by the angle between heading and tangent.
Command round_the_ring(const RacingObservation& seen, double speed) {
  const double x = seen.state.x, y = seen.state.y - 8;
  const double tangent = std::atan2(y, x) + pi / 2, away = std::hypot(x, y) - 8;
  return {0.04 + 0.6 * maps::wrap_angle(tangent - seen.state.yaw) + 0.3 * away, speed};
}

TEST(BenchmarkLine, ItsSplineIsThatOfTheClosedCurve) {
  // The last row counts as the first one.
  auto rows = ring(5, 100);
  rows.push_back(rows.front());
  const BenchmarkLine line(rows);
  for (const double u : {0.0, 0.1, 0.337, 0.9}) {
    const maps::Pose pose = line.pose(u);
    EXPECT_NEAR(std::hypot(pose.x, pose.y - 5), 5, 1e-5) << u;
    EXPECT_NEAR(maps::wrap_angle(pose.yaw - 2 * pi * u), 0, 1e-5) << u;
  }
}

TEST(BenchmarkLine, ProgressIsThatOfTheRowBefore) {
  std::vector<maps::Point> rows;
  for (int i = 0; i <= 20; ++i) rows.push_back({0.5 * i, i % 2 ? 0.001 : 0.0});
  const BenchmarkLine line(rows);
  EXPECT_NEAR(line.length(), 10, 1e-4);
  EXPECT_NEAR(line.progress({5.1, 0.3}), 0.5, 1e-3);   // just behind row 10
  EXPECT_NEAR(line.progress({4.9, 0.3}), 0.45, 1e-3);  // just before it
  EXPECT_NEAR(line.progress({9.9, 0}), 0.95, 1e-3);
  EXPECT_NEAR(line.progress({12, 0}), 0.95, 1e-3);  // still between the last two rows
  EXPECT_LT(line.progress({-1, 0}), 0.05);
  EXPECT_THROW(BenchmarkLine({{0, 0}, {1, 0}, {1, 0}, {2, 0}}), std::invalid_argument);
  EXPECT_THROW(BenchmarkLine({{0, 0}, {1, 0}}), std::invalid_argument);
}

TEST(RacingBenchmark, AResetIsOneControlPeriodAtRest) {
  RacingBenchmark world = ring_world();
  world.reset();
  EXPECT_DOUBLE_EQ(world.time(), 0.04);
  EXPECT_EQ(world.observation().state.speed, 0);
  EXPECT_EQ(world.observation().scan.size(), 1080u);
  EXPECT_FALSE(world.collided());
  world.reset();
  EXPECT_GT(std::hypot(world.observation().state.x, world.observation().state.y), 1) << "a random start";
}

TEST(RacingBenchmark, SteeringTakesEffectTwoStepsLaterAndSpeedAtOnce) {
  RacingBenchmark world = ring_world();
  world.reset();
  world.step(std::array{Command{0.3, 8}});
  // Four steps of 0.01 s, of which two still steer 0; the first accelerates by 0.951 * 8 m/s^2.
  EXPECT_NEAR(world.observation().state.steer, 2 * 0.032, 1e-12);
  EXPECT_NEAR(world.accelerations()[4], 0.951 * 8, 0.01);
  EXPECT_NEAR(world.observation().state.speed, 0.01 * (7.608 + 3 * 9.51), 1e-9);
}

TEST(RacingBenchmark, ALapEndsBetween995And999PerMille) {
  RacingBenchmark world = ring_world();
  for (int lap = 0; lap < 3; ++lap) {
    world.reset();
    while (!world.collided() && !world.complete())
      world.step(std::array{round_the_ring(world.observation(), 2)});
    EXPECT_FALSE(world.collided());
    EXPECT_GT(world.observation().progress, 0.995);
    EXPECT_LE(world.observation().progress, 0.999);
    EXPECT_NEAR(world.time(), 2 * pi * 8 / 2, 1.5);
    EXPECT_EQ(world.accelerations().size(), static_cast<std::size_t>(std::lround(world.time() / 0.01)));
    // v^2 / r = 0.5 m/s^2, but for the start.
    EXPECT_LT(world.accelerations().back(), 3);
  }
}

TEST(RacingBenchmark, ACornerInAWallEndsTheLap) {
  RacingBenchmark world = ring_world();
  world.reset();
  while (!world.collided() && !world.complete()) world.step(std::array{Command{0, 3}});
  EXPECT_TRUE(world.collided());
  // The front corners are 0.29 m ahead of the centre of gravity, the wall 9 m from the middle of the ring.
  const CarState state = world.observation().state;
  EXPECT_NEAR(std::hypot(state.x + 0.29, state.y - 0.155 - 8), 9, 0.2);
}

TEST(FollowTheGap, SteersForTheFarPartAndSlowsDown) {
  FollowTheGap driver;
  std::vector<double> scan(1080, 1.0);
  for (std::size_t i = 0; i < scan.size(); ++i) scan[i] += 1e-4 * std::abs(static_cast<double>(i) - 100);
  for (std::size_t i = 610; i < 690; ++i) scan[i] = 9;
  const Command left = driver.command(scan);
  EXPECT_NEAR(left.steer, 0.5 * (650 - 540) * 2 * pi / 1080, 1e-9);
  EXPECT_EQ(left.speed, 3);
  std::fill(scan.begin(), scan.end(), 1.0);
  scan[140] = 0.5;
  for (std::size_t i = 500; i < 580; ++i) scan[i] = 9;
  EXPECT_NEAR(driver.command(scan).steer, 0, 0.02);
  EXPECT_EQ(driver.command(scan).speed, 5);
  EXPECT_EQ(driver.command(std::vector<double>(100, 1.0)).speed, 0) << "no beams are left";
  EXPECT_EQ(driver.command(std::vector<double>(1080, 0.0)).speed, 0) << "no gap";
}

/// The published means of follow the gap (f1tenth_benchmarks), and how many of ten laps end in a collision.
struct PublishedLaps {
  const char* map;
  double mean;
  int collisions;
};

class PublishedRacing : public ::testing::TestWithParam<PublishedLaps> {};

TEST_P(PublishedRacing, FollowTheGapDrivesTheSameLaps) {
  const char* root = std::getenv("SLALOM_RACING_DIR");
  if (!root) GTEST_SKIP() << "set SLALOM_RACING_DIR to the folder of the benchmark's maps";
  const auto file = std::filesystem::path(root) / GetParam().map / GetParam().map;
  const auto grid = maps::load_ros_map(file.string() + ".yaml", maps::MapRule::grey_threshold);
  std::ifstream stream(file.string() + "_centerline.csv");
  std::vector<maps::Point> rows;
  std::string text;
  std::getline(stream, text);
  for (maps::Point point; std::getline(stream, text);) {
    char comma = 0;
    std::istringstream(text) >> point.x >> comma >> point.y;
    rows.push_back(point);
  }
  RacingBenchmark world(std::make_shared<const Track>(grid), rows);
  FollowTheGap driver;
  double sum = 0;
  int collisions = 0;
  for (int lap = 0; lap < 10; ++lap) {
    world.reset();
    while (!world.collided() && !world.complete())
      world.step(std::array{driver.command(world.observation().scan)});
    collisions += world.collided();
    sum += world.collided() ? 0 : world.time();
  }
  EXPECT_EQ(collisions, GetParam().collisions);
  EXPECT_NEAR(sum / (10 - collisions), GetParam().mean, 0.0005);
}

INSTANTIATE_TEST_SUITE_P(Maps, PublishedRacing,
                         ::testing::Values(PublishedLaps{"aut", 19.097, 3}, PublishedLaps{"esp", 45.784, 0},
                                           PublishedLaps{"gbr", 39.336, 0}, PublishedLaps{"mco", 34.987, 1}),
                         [](const auto& test) { return std::string(test.param.map); });

}  // namespace

}  // namespace slalom::sim
