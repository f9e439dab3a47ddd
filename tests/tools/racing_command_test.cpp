// `slalom reproduce --benchmark racing` on four maps of our own: drivers, results, errors.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "slalom/maps/ros_map.hpp"
#include "tools/program_test.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using testing::content;

constexpr double pi = 3.14159265358979323846, radius = 8;

class RacingCommand : public testing::ProgramTest {
 protected:
  /// A ring through the origin of the map frame, along +x there, under the names of the four maps; two of
  /// them in folders of their own.
  void SetUp() override {
    maps::OccupancyGrid grid{400, 400, 0.05, {-10, -2, 0}, {}};
    for (int row = 0; row < grid.height; ++row)
      for (int column = 0; column < grid.width; ++column) {
        const double away = std::hypot(-10 + 0.05 * (column + 0.5), -10 + 0.05 * (row + 0.5));
        grid.cells.push_back(std::abs(away - radius) < 1 ? maps::Occupancy::free : maps::Occupancy::occupied);
      }
    std::string line = "0,0,1,1\n";
    for (int i = 0; i < 250; ++i)
      line += std::to_string(radius * std::sin(2 * pi * i / 251)) + "," +
              std::to_string(radius - radius * std::cos(2 * pi * i / 251)) + ",1,1\n";
    for (const std::string name : {"aut", "esp", "gbr", "mco"}) {
      const fs::path folder = folder_ / "maps" / (name < "g" ? name : "");
      fs::create_directories(folder);
      maps::save_ros_map(grid, folder / (name + ".yaml"));
      std::ofstream(folder / (name + "_centerline.csv")) << line;
    }
  }
  nlohmann::json drive(const std::string& arguments) const {
    const auto run = program("reproduce --benchmark racing --course maps --quick --json r.json " + arguments);
    EXPECT_EQ(run.status, 0) << run.output;
    return nlohmann::json::parse(content(folder_ / "r.json"));
  }
};

TEST_F(RacingCommand, AnyDriverDrivesEveryMap) {
  // The limit of the planner's speed bounds the lap time from below: 2 pi r / v.
  const auto planned = drive("--driver mppi --set mppi.samples=400 --set planner.max_speed=4");
  EXPECT_EQ(planned["config"], "racing_benchmark");
  EXPECT_EQ(planned["margin_m"], 0.12);
  const auto gap = drive("--driver follow_the_gap");
  for (const char* map : {"aut", "esp", "gbr", "mco"}) {
    for (const auto& results : {planned["maps"][map], gap["maps"][map]}) {
      EXPECT_EQ(results["laps"], 1) << map;
      EXPECT_EQ(results["completed"], 1) << map;
      EXPECT_EQ(results["at_time_limit"], 0) << map;
      EXPECT_EQ(results["lap_times_s"].size(), 1u) << map;
      EXPECT_EQ(results["mean_s"], results["lap_times_s"][0]) << map;
      EXPECT_GE(results["beyond_grip"].get<double>(), 0) << map;
      EXPECT_LE(results["beyond_grip"].get<double>(), 1) << map;
    }
    EXPECT_GT(planned["maps"][map]["mean_s"].get<double>(), 2 * pi * (radius - 1) / 4) << map;
    EXPECT_LT(planned["maps"][map]["mean_s"].get<double>(), 2 * pi * radius / 3) << map;
    EXPECT_EQ(gap["maps"][map], gap["maps"]["aut"]) << "the four maps are the same";
  }
}

TEST_F(RacingCommand, TheRacelineIsThatOfTheCar) {
  // The line of a wide car keeps further from the inner wall, so its circle is longer.
  std::ofstream(folder_ / "wide.yaml") << "vehicle: {body_width: 1.4}\n";
  const std::string arguments = "--driver mppi --set mppi.samples=400 --set planner.max_speed=4";
  const auto usual = drive(arguments), wide = drive(arguments + " --car wide.yaml");
  EXPECT_EQ(wide["car"], "wide.yaml");
  for (const char* map : {"aut", "mco"})
    EXPECT_GT(wide["maps"][map]["mean_s"].get<double>(), usual["maps"][map]["mean_s"].get<double>() + 0.3)
        << map;
}

TEST_F(RacingCommand, SaysWhatIsWrong) {
  expect_refused("reproduce --benchmark racing --course maps --car tractor", {"--car: tractor", "default"});
  expect_refused("reproduce --car f1tenth --out x", {"--car", "--benchmark"});
  expect_refused("reproduce --benchmark rowing --course maps", {"--benchmark", "rowing", "racing"});
  expect_refused("reproduce --benchmark racing", {"--course", "folder"});
  expect_refused("reproduce --benchmark racing --course nowhere", {"nowhere", "aut.yaml"});
  expect_refused("reproduce --benchmark racing --course maps --driver tortoise", {"tortoise", "svg_mppi"});
  expect_refused("reproduce --benchmark racing --course maps --margin 2.25", {"no closed way", "1.055"});
  expect_refused("reproduce --driver mppi --out x", {"--driver", "--benchmark"});
  expect_refused("reproduce --margin 0.1 --out x", {"--margin", "--benchmark"});
  expect_refused("reproduce --course wren", {"--out", "is required"});
}

}  // namespace
}  // namespace slalom::tools
