// `slalom drive`: results in JSON, exit status, repeatability, interruption, and bad inputs named in words.
#include "slalom/evaluation/hardware.hpp"
#include "tools/program_test.hpp"
#include "view/recording/mcap_reader.hpp"

namespace slalom::tools {
namespace {

class DriveCommand : public testing::ProgramTest {
 protected:
  /// Drives on the smallest course with few samples, unless the arguments say otherwise.
  std::string drive(const std::string& arguments) const {
    return succeed("drive --course wren --set samples=256 " + arguments);
  }
  /// The same until the lap ends without a finish, after so many seconds.
  void drive_for(double seconds, const std::string& arguments) const {
    fs::copy(SLALOM_COURSES "/wren", folder_ / "short",
             fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    std::ofstream(folder_ / "short/course.yaml") << "timeout: " << seconds << "\n";
    const auto run = program("drive --course short --set samples=256 --json out.json " + arguments);
    EXPECT_EQ(run.status, 1) << arguments << ": " << run.output;
  }
};

TEST_F(DriveCommand, ParksCarsAtGivenPlaces) {
  const std::string drive = "drive --course wren --set samples=256 --obstacles 3 --laps 1 --json out.json ";
  expect_says(program(drive + "--obstacle 1.5,0.25,0.1 --obstacle=-3,2,0").output, {"3 obstacles"});
  const json told = result("out.json");
  ASSERT_EQ(told["laps"][0]["obstacles"].size(), 3u);
  EXPECT_EQ(told["laps"][0]["obstacles"][0], json({1.5, 0.25, 0.1}));
  EXPECT_EQ(told["settings"]["obstacle_places"][1], json({-3, 2, 0}));
  expect_refused("drive --course wren --obstacle 1,2", {"--obstacle", "'1,2'", "x,y,yaw"});
}

TEST_F(DriveCommand, DrawsALapAtUtmCoordinates) {
  std::ofstream line(folder_ / "arc.csv");
  line << std::fixed;
  for (double a = 0; a < 4; a += 0.1)
    line << 450000 + 6 * std::cos(a) << "," << 5400000 + 6 * std::sin(a) << ",1.1,1.1\n";
  line.close();
  succeed("course arc.csv --no-picture --out arc");
  // Within 4 GB of memory.
  const auto run = testing::run_shell("ulimit -v 4000000; '" SLALOM_PROGRAM
                                      "' drive --course arc --set samples=256 --plot lap.png",
                                      folder_.string());
  EXPECT_EQ(run.status, 0) << run.output;
  EXPECT_GT(fs::file_size(folder_ / "lap.png"), 10000u);
}

TEST_F(DriveCommand, TheNoteOnTheProfileIsThatOfTheCar) {
  const std::string drive =
      "drive --course wren --method mppi --set mppi.samples=50 --set planner.max_speed=3 ";
  const std::string words = "asks for more than the car can (";
  EXPECT_NE(succeed(drive + "--set vehicle.friction=1 2>&1").find(words + "8.34"), std::string::npos);
  EXPECT_NE(succeed(drive + "--set vehicle.friction=0.4 2>&1").find(words + "3.34"), std::string::npos);
}

TEST_F(DriveCommand, DrivesACarOfFullSize) {
  // Two straights of 150 m and two half circles of 45 m; the road is 14 m wide.
  std::ofstream line(folder_ / "oval.csv");
  constexpr double pi = 3.14159265358979, radius = 45, straight = 150;
  for (double x = 0; x < straight; x += 5) line << x << ",0,7,7\n";
  for (double a = -pi / 2; a < pi / 2; a += 0.1)
    line << straight + radius * std::cos(a) << "," << radius + radius * std::sin(a) << ",7,7\n";
  for (double x = straight; x > 0; x -= 5) line << x << "," << 2 * radius << ",7,7\n";
  for (double a = pi / 2; a < 3 * pi / 2; a += 0.1)
    line << radius * std::cos(a) << "," << radius + radius * std::sin(a) << ",7,7\n";
  line.close();
  succeed(
      "course oval.csv --car passenger --margin 1 --top-speed 35 --friction 0.85 --no-picture --out oval");
  const std::string arguments =
      "drive --course oval --config passenger_car --set samples=1000 --set world.car=passenger_car "
      "--set world.saturating_tyres=true ";
  succeed(arguments + "--json out.json");
  const json lap = result("out.json")["laps"][0];
  EXPECT_EQ(lap["collisions"], 0);
  EXPECT_GT(lap["mean_speed"], 15);
  EXPECT_LT(lap["time"], 35);
  EXPECT_LT(lap["max_path_distance"], 5);
  expect_refused(arguments + "--hardware", {"world.car", "passenger_car", "sensors of a real car"});
}

TEST_F(DriveCommand, FinishesLapsAndWritesJson) {
  const std::string said = drive("--obstacles 2 --laps 2 --seed 3 --json out.json");
  const json d = result("out.json");
  ASSERT_EQ(d["laps"].size(), 2u);
  for (const auto& lap : d["laps"]) {
    EXPECT_EQ(lap["finished"], true);
    EXPECT_EQ(lap["timeout"], false);
    EXPECT_GT(lap["time"].get<double>(), 5);
    EXPECT_GT(lap["steps"].get<int>(), 100);
    EXPECT_NEAR(lap["mean_sequence_cost"].get<double>(),
                lap["state_cost"].get<double>() + lap["collision_cost"].get<double>(), 1e-9);
    EXPECT_TRUE(lap["collisions"].is_number_integer());
    EXPECT_EQ(lap["obstacles"].size(), 2u);
  }
  EXPECT_EQ(d["laps"][0]["seed"], 3);
  EXPECT_EQ(d["laps"][1]["seed"], 10);
  EXPECT_LE(d["solve_ms"]["p50"], d["solve_ms"]["p99"]);
  EXPECT_LE(d["solve_ms"]["p99"], d["solve_ms"]["max"]);
  EXPECT_EQ(d["settings"]["course"], "wren");
  EXPECT_EQ(d["settings"]["options"]["svg_mppi"]["samples"], 256);
  EXPECT_TRUE(d["settings"]["options"].contains("vehicle"));
  EXPECT_EQ(d["settings"]["threads"], 1);
  testing::expect_says(said, {"2 of 2 laps finished"});
}

TEST_F(DriveCommand, GivesTheSameBytesForTheSameSeedAndAnyThreads) {
  const auto cleaned = [&](const std::string& arguments) {
    drive_for(2, arguments + " --obstacles 2 --laps 2 --record out.mcap");
    json d = result("out.json");
    d.erase("solve_ms");
    d["settings"].erase("threads");
    return std::pair(d.dump(), content(folder_ / "out.mcap"));
  };
  const auto first = cleaned("--threads 1");
  EXPECT_EQ(cleaned("--threads 2"), first);
  EXPECT_NE(cleaned("--seed 1").first, first.first);
}

TEST_F(DriveCommand, OpponentsWithPlannersHaveTheOptionsOfTheFileAndAreRecorded) {
  const std::string among =
      "--opponents 1 --set world.planning_opponents=1 --set world.opponent_gap=3 --set world.tracking=exact ";
  const auto recorded = [&](const std::string& arguments) {
    drive_for(4, among + arguments + " --record out.mcap");
    return content(folder_ / "out.mcap");
  };
  const std::string first = recorded("--threads 1");
  EXPECT_EQ(recorded("--threads 2"), first);
  const json settings = result("out.json")["settings"];
  EXPECT_EQ(settings["options"]["world"]["planning_opponents"], 1);
  EXPECT_EQ(settings["options"]["svg_mppi"]["samples"], 256);
  EXPECT_EQ(settings["opponent_planner"]["method"], "svg_mppi");
  EXPECT_EQ(settings["opponent_planner"]["options"]["svg_mppi"]["samples"], 2560) << "that of default.yaml";
  EXPECT_FALSE(result("out.json")["laps"][0]["overtaking"]["encounters"].empty());
  expect_refused("drive --set world.planning_opponents=1", {"world.planning_opponents", "world.opponents"});
  expect_refused("drive --opponents 5 --set world.planning_opponents=5", {"planning_opponents", "[0, 4]"});
  expect_refused("drive --evaluation published --set world.planning_opponents=1",
                 {"planning_opponents", "published"});
}

TEST_F(DriveCommand, WritesOnlyJsonToStandardOutput) {
  const json told = json::parse(drive("--json - 2>/dev/null"));
  EXPECT_EQ(told["laps"].size(), 1u);
  EXPECT_TRUE(told["summary"]["collision_rate"].is_null());
}

TEST_F(DriveCommand, RecordsEveryStepAndDraws) {
  drive("--json out.json --record out.mcap --plot out.png");
  std::vector<json> ticks;
  view::mcap::read_records((folder_ / "out.mcap").string(), false,
                           {.message =
                                [&](const view::mcap::MessageView& message) {
                                  if (message.topic == "/tick") ticks.push_back(json::parse(message.data));
                                },
                            .attachment = {}});
  ASSERT_EQ(ticks.size(), result("out.json")["laps"][0]["steps"]);
  EXPECT_EQ(ticks[0]["plan"].size(), 21u);
  EXPECT_NEAR(ticks.back()["time"].get<double>(), result("out.json")["laps"][0]["time"], 0.05);
  EXPECT_NEAR(ticks.back()["steering_offset_estimate"].get<double>(),
              result("out.json")["laps"][0]["estimation"]["steering_offset_rad"], 1e-6);
  EXPECT_EQ(content(folder_ / "out.png").substr(1, 3), "PNG");
}

TEST_F(DriveCommand, LearnsTheOffsetOfTheSteeringOfARealCar) {
  const auto offset = [&](const std::string& arguments) {
    drive("--hardware --json out.json " + arguments);
    return result("out.json")["laps"][0]["estimation"]["steering_offset_rad"].get<double>();
  };
  EXPECT_NEAR(offset(""), evaluation::HardwareConditions{}.steering_offset, 0.006);
  EXPECT_EQ(offset("--set planner.identify=false"), 0);
}

TEST_F(DriveCommand, FailsWhereALapIsNotFinishedButWritesResults) {
  drive_for(0.5, "");
  EXPECT_EQ(result("out.json")["laps"][0]["finished"], false);
  EXPECT_EQ(result("out.json")["laps"][0]["timeout"], true);
}

TEST_F(DriveCommand, CtrlCEndsTheLapAndWritesResults) {
  const auto run = program(
      "drive --course swift --laps 1000 --json out.json > words.txt & pid=$!; sleep 1.5; kill -INT $pid; "
      "wait $pid");
  EXPECT_EQ(run.status, 130);
  const json d = result("out.json");
  ASSERT_FALSE(d["laps"].empty());
  EXPECT_EQ(d["laps"].back()["interrupted"], true);
  EXPECT_EQ(d["laps"].back()["finished"], false);
  EXPECT_GT(d["laps"].back()["steps"].get<int>(), 0);
}

TEST_F(DriveCommand, DrivesThePublishedEvaluation) {
  drive("--config published --evaluation published --method mppi --obstacles 1 --json out.json");
  const json d = result("out.json");
  EXPECT_EQ(d["settings"]["control_period_s"], 0.01);
  const double steps = d["laps"][0]["steps"], time = d["laps"][0]["time"];
  EXPECT_NEAR(time, 0.01 * (steps + 1), 1e-9);
}

TEST_F(DriveCommand, RejectsInvalidArguments) {
  expect_refused("drive --course nowhere", {"nowhere", "known: "});
  expect_refused("drive --config nothing", {"nothing", "known: ", "published"});
  expect_refused("drive --method magic", {"magic", "svg_mppi"});
  expect_refused("drive --evaluation maybe", {"maybe", "must be 'true' or 'published'"});
  expect_refused("drive --set samples", {"--set", "key=value"});
  expect_refused("drive --set sampels=3", {"--set", "sampels", "did you mean svg_mppi.samples?"});
  expect_refused("drive --set samples=0", {"--set", "samples", "'0'", "must be in [1,"});
  expect_refused("drive --set vehicle.time_step=soon", {"vehicle.time_step", "'soon'", "must be a number"});
  expect_refused("drive --set planner.verify_plan=maybe", {"'maybe'", "true or false"});
  expect_refused("drive --set guide_weight=heavy", {"'heavy'", "must be one of"});
  expect_refused("drive --set variance=[0.1,0.2,0.3]", {"variance", "3 values"});
  expect_refused("drive --start 0,0", {"--start", "x,y,yaw"});
  expect_refused("drive --start 0,0,nan", {"--start", "within 1e7 m"});
  expect_refused("drive --course wren --start 1e6,0,0", {"start", "on the map"});
  expect_refused("drive --obstacles 900", {"parked cars could be placed"});
  expect_refused("drive --evaluation published --latency-ms 5", {"latency", "published"});
  write("wrong.yaml", "svg_mppi:\n  samples: many\n");
  expect_refused("drive --config wrong.yaml", {"wrong.yaml:2", "svg_mppi.samples", "must be an integer"});
}

TEST(OptionsCommand, ListsDeclarations) {
  const auto run = run_program("options --method svg_mppi --json - --config published --set samples=77");
  ASSERT_EQ(run.status, 0) << run.output;
  const json d = json::parse(run.output);
  EXPECT_TRUE(d.contains("vehicle"));
  EXPECT_TRUE(d.contains("planner"));
  EXPECT_FALSE(d.contains("mppi"));
  for (const auto& option : d["svg_mppi"]) {
    if (option["name"] != "samples") continue;
    EXPECT_EQ(option["value"], "77");
    EXPECT_EQ(option["symbol"], "K");
    EXPECT_EQ(option["type"], "integer");
    EXPECT_EQ(option["min"], 1);
  }
  EXPECT_NE(run_program("options --method svg_mppi").output.find("temperature"), std::string::npos);
  EXPECT_EQ(run_program("options --config nothing").status, 2);
}

TEST(OptionsCommand, WritesAFileThatIsReadBack) {
  const testing::ScopedFolder folder;
  const fs::path file = folder.path() / "published.yaml";
  ASSERT_EQ(run_program("options --config published --yaml > " + file.string()).status, 0);
  EXPECT_EQ(run_program("options --config published --yaml").output,
            run_program("options --config " + file.string() + " --yaml").output);
}

}  // namespace
}  // namespace slalom::tools
