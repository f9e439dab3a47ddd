#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "golden.hpp"
#include "sim/golden_table.hpp"
#include "slalom/sim/laps.hpp"
#include "slalom/sim/numpy_random.hpp"
#include "slalom/sim/placement.hpp"
#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/sim/shapes.hpp"

namespace slalom::sim {
namespace {

using slalom::testing::Comparison;
using slalom::testing::GoldenTable;

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

Box box_of(const GoldenTable& t, std::size_t row, const std::string& suffix = "") {
  Box box{{t.real(row, "x" + suffix), t.real(row, "y" + suffix), t.real(row, "yaw" + suffix)}, 0.58, 0.31};
  if (t.has("length")) box.length = t.real(row, "length"), box.width = t.real(row, "width");
  return box;
}

TEST(GymRules, Vertices) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / "vertices.csv");
  Comparison compared("vertices");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    compared.next_case();
    const auto actual = corners(box_of(table, row));
    const char* names[] = {"rl", "rr", "fr", "fl"};
    for (std::size_t i = 0; i < 4; ++i) {
      compared.absolute(actual[i].x, table.real(row, std::string(names[i]) + "_x"));
      compared.absolute(actual[i].y, table.real(row, std::string(names[i]) + "_y"));
    }
  }
  EXPECT_GT(compared.cases(), 0);
  EXPECT_LE(compared.worst(), 1e-9);
}

TEST(GymRules, PairCollisions) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / "gjk_pairs.csv");
  Comparison compared("gjk_pairs");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    compared.next_case();
    const double gap = signed_gap(box_of(table, row, "1"), box_of(table, row, "2"));
    EXPECT_EQ(gap <= 0, table.integer(row, "collide") == 1) << "case " << table.text(row, "case");
    compared.absolute(gap, table.real(row, "sat_signed_gap"));
  }
  EXPECT_GT(compared.cases(), 0);
  EXPECT_LE(compared.worst(), 1e-9);
}

TEST(GymRules, CollisionsOfMany) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / "collision_multiple.csv");
  Comparison compared("collision_multiple");
  for (std::size_t begin = 0, end; begin < table.rows(); begin = end) {
    end = begin;
    while (end < table.rows() && table.text(end, "case") == table.text(begin, "case")) ++end;
    compared.next_case();
    for (std::size_t i = begin; i < end; ++i) {
      int partner = -1;
      // The last pair in the order (0,1), (0,2), ..., (1,2), ... that has i in it and collides.
      for (std::size_t j = begin; j < end; ++j)
        if (j != i && signed_gap(box_of(table, i), box_of(table, j)) <= 0)
          partner = static_cast<int>(j - begin);
      compared.absolute(partner >= 0, table.integer(i, "collision"));
      compared.absolute(partner, table.integer(i, "collision_idx"));
    }
  }
  EXPECT_GT(compared.cases(), 0);
  EXPECT_EQ(compared.worst(), 0);
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
      compared.absolute(0.01 * random.normal(), table.real(row, scan));
  }
  EXPECT_LE(compared.worst(), 1e-15);
}

TEST(GymRules, ParkedCars) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / "obstacles.csv");
  std::vector<maps::Point> path;
  for (const PathPoint& p : opponent_path(folder / "maps/berlin/opp_ref_path.csv")) path.push_back(p.point);
  Comparison compared("obstacles");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    compared.next_case();
    const int index = table.integer(row, "i");
    const auto cars =
        place_at_random(path, index + 1, static_cast<std::uint64_t>(table.integer(row, "seed")));
    const Placement& car = cars.at(static_cast<std::size_t>(index));
    EXPECT_EQ(static_cast<int>(car.waypoint), table.integer(row, "waypoint_row"));
    compared.absolute(car.pose.x, table.real(row, "x"));
    compared.absolute(car.pose.y, table.real(row, "y"));
    compared.absolute(car.pose.yaw, table.real(row, "yaw"));
  }
  EXPECT_GT(compared.cases(), 0);
  EXPECT_LE(compared.worst(), 1e-12);
}

TEST(GymRules, PurePursuit) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / "pure_pursuit.csv");
  const PurePursuit driver(opponent_path(folder / "maps/berlin/opp_ref_path.csv"),
                           {.gym = GymPurePursuit::all()});
  Comparison compared("pure_pursuit");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    compared.next_case();
    const maps::Pose pose{table.real(row, "x"), table.real(row, "y"), table.real(row, "yaw")};
    const auto target = driver.target({pose.x, pose.y});
    const Command command = driver.command(pose);
    using Mode = PurePursuit::Target::Mode;
    const char* mode = target.mode == Mode::lookahead   ? "lookahead"
                       : target.mode == Mode::reacquire ? "reacquire"
                                                        : "none";
    EXPECT_EQ(mode, table.text(row, "mode"));
    EXPECT_EQ(static_cast<int>(target.nearest.segment), table.integer(row, "nearest_seg"));
    EXPECT_EQ(target.row, table.integer(row, "target_row")) << "case " << table.text(row, "case");
    compared.absolute(target.nearest.distance, table.real(row, "nearest_dist"));
    compared.absolute(target.nearest.along, table.real(row, "nearest_t"));
    compared.absolute(target.along, table.real(row, "target_t"));
    compared.absolute(command.speed, table.real(row, "speed"));
    compared.absolute(command.steer, table.real(row, "steer"));
    EXPECT_LE(compared.worst(), 1e-9) << "case " << table.text(row, "case");
  }
  EXPECT_GT(compared.cases(), 0);
}

TEST(GymRules, Laps) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / "lap_trace.csv");
  Comparison compared("lap_trace");
  std::vector<StartZoneLaps> cars;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto agent = static_cast<std::size_t>(table.integer(row, "agent"));
    if (table.integer(row, "k") == 0) {
      if (agent == 0) compared.next_case();
      if (agent == 0) cars.clear();
      cars.emplace_back();
      const double heading = agent == 0 ? table.real(row, "start_yaw") : table.real(row - agent, "start_yaw");
      cars[agent].reset({table.real(row, "start_x"), table.real(row, "start_y")}, heading);
    }
    StartZoneLaps& car = cars.at(agent);
    car.update({table.real(row, "x"), table.real(row, "y")}, table.real(row, "time"));
    compared.absolute(car.near_start(), table.integer(row, "near_start"));
    compared.absolute(car.toggles(), table.integer(row, "toggles"));
    compared.absolute(car.laps(), table.integer(row, "lap_count"));
    compared.absolute(car.time(), table.real(row, "lap_time"));
    compared.absolute(car.finished(), table.integer(row, "checkpoint_done"));
    ASSERT_EQ(compared.worst(), 0) << "row " << row;
  }
  EXPECT_GT(compared.cases(), 0);
}

}  // namespace
}  // namespace slalom::sim
