
#include <nlohmann/json.hpp>

#include "sim/golden_table.hpp"
#include "slalom/sim/gym.hpp"
#include "slalom/sim/laps.hpp"
#include "slalom/sim/placement.hpp"
#include "slalom/sim/pure_pursuit.hpp"
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

}  // namespace
}  // namespace slalom::sim
