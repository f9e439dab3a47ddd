// `slalom hardware`, `slalom identify` and `slalom replay` of a bag: what they find of a drive that is known,
// and what they say of bad input. And what `slalom bench` measures of models with two inputs.
#include <nlohmann/json.hpp>

#include "slalom/maps/ros_map.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "tools/program_test.hpp"
#include "tools/recording/bag_writer.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::BagWriter;
using testing::content;
using testing::Wire;

const fs::path wren = fs::path(SLALOM_COURSES) / "wren";

std::vector<json> lines_of(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<json> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(json::parse(line));
  return lines;
}

class HardwareCommand : public testing::ProgramTest {
 protected:
  /// Two short laps; what does not depend on the clock of the wall.
  json results(const std::string& arguments) const {
    const auto run = program(
        "hardware --drivers mppi@default_kinematic --set samples=64 --tracking-laps 1 --layouts 1 --laps 1 "
        "--obstacles "
        "2 "
        "--json out.json " +
        arguments);
    EXPECT_EQ(run.status, 0) << run.output;
    json told = json::parse(content(folder_ / "out.json"));
    for (json& row : told["results"])
      for (const char* clock : {"localisation_ms", "solve_ms"}) row.erase(clock);
    return told;
  }
};

TEST_F(HardwareCommand, RepeatsWithAnyNumberOfJobsAndAppliesItsSettings) {
  const json one = results("--jobs 1");
  EXPECT_EQ(results("--jobs 2"), one);
  ASSERT_EQ(one["results"].size(), 2u);
  EXPECT_EQ(one["results"][0]["scenario"], "pt");
  EXPECT_EQ(one["results"][0]["laps"], 1);
  EXPECT_EQ(one["results"][0]["finished"], 1);
  EXPECT_GT(one["results"][0]["localisation_error_m"]["mean"], 0.001);
  EXPECT_LT(one["results"][0]["localisation_error_m"]["p99"], 0.5);
  EXPECT_EQ(one["results"][1]["scenario"], "oa");
  EXPECT_EQ(one["conditions"]["steering_gain"], "0.95");
  EXPECT_EQ(one["latency_ms"], 10);
  EXPECT_NE(results("--latency-ms 40")["results"], one["results"]);
  EXPECT_NE(results("--set planner.max_speed=1")["results"], one["results"]);
}

TEST_F(HardwareCommand, ReportsTheErrorsOfTheStateEstimatesOfACarWhoseTyresSlip) {
  const auto run = program(
      "hardware --drivers mppi@default,mppi@default_kinematic --set samples=256 --tracking-laps 1 --layouts "
      "0 "
      "--json out.json");
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_NE(run.output.find("error of yaw rate "), std::string::npos) << run.output;
  const json rows = json::parse(content(folder_ / "out.json"))["results"];
  ASSERT_EQ(rows.size(), 2u);
  const json& errors = rows[0]["estimation"];
  // The sensors have noise, so no estimate is exact. The car turns at 3 rad/s and drives at 5 m/s.
  const std::pair<const char*, double> bounds[] = {
      {"yaw_rate_rms", 0.3}, {"slip_rms", 0.1}, {"speed_rms", 0.5}};
  for (const auto& [key, largest] : bounds) {
    EXPECT_GT(errors[key], 1e-4) << key;
    EXPECT_LT(errors[key], largest) << key;
  }
  EXPECT_FALSE(rows[1].contains("estimation")) << "a model without slip estimates no slip";
}

class BenchCommand : public testing::ProgramTest {};

TEST_F(BenchCommand, MeasuresModelsWithTwoInputs) {
  for (const std::string config : {"default", "default_speed"}) {
    const auto run = program("bench --config " + config +
                             " --methods svg_mppi --set svg_mppi.samples=256 --seconds 0.01 --json b.json");
    ASSERT_EQ(run.status, 0) << run.output;
    const json told = json::parse(content(folder_ / "b.json"));
    EXPECT_GT(told["rollout_ns_per_step"], 0) << config;
    EXPECT_GT(told["methods"]["svg_mppi"]["solve_ms"]["p50"], 0) << config;
    EXPECT_GT(told["tick_ms"], told["tick"]["without_solve_ms"]["p50"]) << config;
    EXPECT_FALSE(told.contains("rollout_gflops")) << "only the operations of the fixed workload are known";
    ASSERT_EQ(told["vehicle_models"].size(), 4u);
    EXPECT_EQ(told["vehicle_models"][0]["times_the_first"], 1);
    EXPECT_EQ(told["vehicle_models"][3]["model"], "single_track, saturating tyres");
    EXPECT_GT(told["vehicle_models"][3]["rollout_ns_per_step"], 0);
  }
}

TEST_F(HardwareCommand, RejectsInvalidArguments) {
  expect_refused("hardware --course nowhere", {"nowhere", "known: "});
  expect_refused("hardware --drivers magic@default", {"magic", "svg_mppi"});
  expect_refused("hardware --drivers mppi@nothing", {"nothing", "known: "});
  expect_refused("hardware --set samples=0", {"--set", "'0'", "must be in [1,"});
  expect_refused("hardware --laps 0", {"--laps"});
  expect_refused("hardware --latency-ms -1", {"--latency-ms"});
  expect_refused("hardware --latency-ms soon", {"--latency-ms"});
  expect_refused("hardware --jobs 0", {"--jobs"});
}

class IdentifyCommand : public testing::ProgramTest {
 protected:
  json identified(const std::string& recording) const {
    const auto run = program("identify " + recording + " --wheelbase 0.3302 --json found.json");
    EXPECT_EQ(run.status, 0) << run.output;
    return json::parse(content(folder_ / "found.json"));
  }
};

TEST_F(IdentifyCommand, FindsTheServoOfASimulatedCar) {
  ASSERT_EQ(program("drive --course eel --config default_kinematic --method mppi --set samples=256 "
                    "--hardware --laps 3 --record lap.jsonl")
                .status,
            0);
  const json found = identified("lap.jsonl");
  EXPECT_NEAR(found["steering_gain"]["value"], 0.95, 0.05);
  EXPECT_NEAR(found["steering_offset"]["value"], 0.01, 0.004);
  EXPECT_NEAR(found["time_constant"]["value"], 0.07, 0.025);
  EXPECT_NEAR(found["delay"]["value"], 0.045, 0.015);
  EXPECT_GT(found["explained"], 0.9);
  EXPECT_EQ(found["wheelbase"]["deviation"], 0);

  const auto free = program("identify lap.jsonl --json free.json");
  ASSERT_EQ(free.status, 0) << free.output;
  EXPECT_NE(free.output.find("determines only the ratio of gain and wheelbase"), std::string::npos)
      << free.output;
  EXPECT_EQ(free.output.find("front_length"), std::string::npos) << free.output;
  const json sought = json::parse(content(folder_ / "free.json"));
  const double ratio =
      sought["steering_gain"]["value"].get<double>() / sought["wheelbase"]["value"].get<double>();
  EXPECT_NEAR(ratio, 0.95 / 0.3302, 0.15);
}

TEST_F(IdentifyCommand, FindsTheFrictionOfASimulatedCarWhoseTyresSlip) {
  ASSERT_EQ(program("drive --course fox --set samples=1000 --set world.saturating_tyres=true --set "
                    "world.friction=0.6 --laps 2 --record lap.jsonl")
                .status,
            0);
  const auto run = program("identify lap.jsonl --tyres --config default --json found.json");
  ASSERT_EQ(run.status, 0) << run.output;
  const json found = json::parse(content(folder_ / "found.json"));
  EXPECT_NEAR(found["friction"]["value"], 0.6, 0.06);
  EXPECT_NEAR(found["cornering_front"]["value"], 4.718, 0.9);
  EXPECT_NEAR(found["cornering_rear"]["value"], 5.4562, 1.1);
  EXPECT_NEAR(found["steering_gain"]["value"], 1, 0.08);
  EXPECT_NEAR(found["delay"]["value"], 0.02, 0.01);
  EXPECT_NE(run.output.find("  friction: "), std::string::npos) << run.output;
  expect_refused("identify lap.jsonl --config default", {"--config", "--tyres"});
  expect_refused("identify lap.jsonl --tyres --wheelbase 0.33", {"--wheelbase", "--tyres"});
  expect_refused("identify lap.jsonl --tyres --config nothing", {"nothing", "known: "});
}

TEST_F(IdentifyCommand, RejectsInvalidInput) {
  expect_refused("identify nothing.jsonl", {"nothing.jsonl", "cannot be read"});
  std::ofstream(folder_ / "text.jsonl") << "hello\n";
  expect_refused("identify text.jsonl", {"text.jsonl:1", "must be a record"});
  std::ofstream(folder_ / "other.jsonl") << "{\"type\":\"tick\"}\n";
  expect_refused("identify other.jsonl", {"other.jsonl:1", "must be the first line of a recording"});
  std::ofstream(folder_ / "torn.jsonl")
      << "{\"type\":\"recording\",\"version\":1}\n{\"type\":\"tick\",\"time\":0}\n";
  expect_refused("identify torn.jsonl", {"torn.jsonl:2", "odometry"});
  std::ofstream(folder_ / "empty.jsonl") << "{\"type\":\"recording\",\"version\":1}\n";
  expect_refused("identify empty.jsonl", {"200"});
  expect_refused("identify empty.jsonl --wheelbase -1", {"wheelbase"});
}

Wire& put_pose(Wire& wire, double x, double y, double yaw) {
  for (const double value : {x, y, 0.0, 0.0, 0.0, std::sin(yaw / 2), std::cos(yaw / 2)}) wire.put(value);
  return wire;
}

Wire odometry(double stamp, const json& o) {
  Wire wire;
  wire.header(stamp, "map").text("base_link");
  put_pose(wire, o[0], o[1], o[2]).zeros(36 * 8);
  return wire.put(o[3].get<double>()).zeros(5 * 8 + 36 * 8);
}

Wire scan(double stamp, const json& tick) {
  const json& shape = tick["scan"];
  const auto f = [&](int i) { return shape[static_cast<std::size_t>(i)].get<float>(); };
  const auto beams = static_cast<std::uint32_t>(tick["ranges"].size());
  Wire wire;
  wire.header(stamp, "laser").put(f(0)).put(f(0) + f(1) * static_cast<float>(beams - 1)).put(f(1));
  wire.zeros(8).put(f(2)).put(f(3)).put(beams);
  for (const json& range : tick["ranges"]) wire.put(range.get<float>());
  return wire.put(std::uint32_t{0});
}

Wire drive(double stamp, double steer, double speed) {
  Wire wire;
  wire.header(stamp, "base_link").put(static_cast<float>(steer)).put(0.0f).put(static_cast<float>(speed));
  return wire.zeros(8);
}

Wire map_message(const maps::OccupancyGrid& map) {
  Wire wire;
  wire.header(0, "map").zeros(8).put(static_cast<float>(map.resolution)).put(map.width).put(map.height);
  put_pose(wire, map.origin.x, map.origin.y, map.origin.yaw)
      .put(static_cast<std::uint32_t>(map.cells.size()));
  for (const maps::Occupancy cell : map.cells)
    wire.put(static_cast<std::int8_t>(cell == maps::Occupancy::free       ? 0
                                      : cell == maps::Occupancy::occupied ? 100
                                                                          : -1));
  return wire;
}

Wire waypoint_message(const std::vector<vehicle::Waypoint>& path) {
  const auto count = static_cast<std::uint32_t>(path.size());
  Wire wire;
  wire.header(0, "map").put(count);
  for (const auto& point : path) put_pose(wire.header(0, "map"), point.x, point.y, point.yaw);
  wire.put(count);
  for (const auto& point : path) wire.header(0, "map").put(point.speed).zeros(5 * 8);
  return wire;
}

Wire laser_message() {
  Wire wire;
  wire.put(std::uint32_t{1}).header(0, "base_link").text("laser");
  return put_pose(wire, 0.275, 0, 0);
}

/// A drive in the simulator, as a recording and as the bag that a car would have made of it.
class BagReplay : public IdentifyCommand {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    ASSERT_EQ(program("drive --course wren --config default_kinematic --method mppi --set samples=256 "
                      "--hardware --record lap.jsonl")
                  .status,
              0);
    write("lap.bag", bag(true).bytes());
  }

  BagWriter bag(bool with_course) const {
    constexpr double begin = 1000;  // s
    BagWriter bag;
    if (with_course) {
      const vehicle::Course course = vehicle::load_course(wren);
      bag.add("/map", "nav_msgs/OccupancyGrid", map_message(course.map));
      bag.add("/reference_waypoint", "waypoint_msg/Waypoint", waypoint_message(course.waypoints));
    }
    bag.add("/tf_static", "tf2_msgs/TFMessage", laser_message());
    for (const json& tick : lines_of(folder_ / "lap.jsonl")) {
      if (tick["type"] != "tick") continue;
      const double stamp = begin + tick["time"].get<double>();
      bag.add("/odom", "nav_msgs/Odometry", odometry(stamp, tick["odometry"]));
      bag.add("/scan", "sensor_msgs/LaserScan", scan(stamp, tick));
      bag.add("/pf/pose/odom", "nav_msgs/Odometry", odometry(stamp, tick["odometry"]));
      bag.add("/drive", "ackermann_msgs/AckermannDriveStamped",
              drive(stamp + 0.005, tick["command"][0], tick["command"][1]));
    }
    return bag;
  }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
};

TEST_F(BagReplay, IdentifiesTheSameModelAsTheRecording) {
  const json a = identified("lap.jsonl"), b = identified("lap.bag");
  EXPECT_EQ(a["samples"], b["samples"]);
  for (const char* key : {"steering_gain", "steering_offset", "delay", "time_constant"})
    EXPECT_NEAR(a[key]["value"], b[key]["value"], 1e-3) << key;
}

TEST_F(BagReplay, RunsThePlannerOnTheBag) {
  const auto run = program("replay lap.bag --method mppi --set samples=256 --record again.jsonl");
  ASSERT_EQ(run.status, 0) << run.output;
  const auto first = lines_of(folder_ / "lap.jsonl"), again = lines_of(folder_ / "again.jsonl");
  ASSERT_EQ(again.size(), first.size());
  double sum = 0;
  for (std::size_t i = 2; i + 1 < first.size(); ++i) {
    ASSERT_EQ(again[i]["ranges"], first[i]["ranges"]) << i;
    for (std::size_t k = 0; k < 4; ++k)
      ASSERT_NEAR(again[i]["odometry"][k], first[i]["odometry"][k], 1e-9) << i;
    const double difference = again[i]["command"][0].get<double>() - first[i]["command"][0].get<double>();
    sum += difference * difference;
  }
  // The same planner with another seed sees the same, and so commands about the same.
  EXPECT_LT(std::sqrt(sum / static_cast<double>(first.size())), 0.06);
  EXPECT_GT(again[again.size() - 2]["step"], 100);

  const auto page = program("replay lap.bag --set samples=64 --html page.html");
  ASSERT_EQ(page.status, 0) << page.output;
  EXPECT_NE(content(folder_ / "page.html").find("x-slalom-replay"), std::string::npos);
  EXPECT_EQ(program("replay lap.bag --set samples=64 --record lap.mcap").status, 0);
  EXPECT_EQ(program("replay lap.mcap --html again.html").status, 0);
}

TEST_F(BagReplay, AcceptsBagsWithoutACourseIfOneIsNamed) {
  write("bare.bag", bag(false).bytes());
  expect_refused("replay bare.bag --record x.jsonl", {"bare.bag", "/map", "--course"});
  const auto run = program("replay bare.bag --course wren --set samples=64 --record x.jsonl");
  EXPECT_EQ(run.status, 0) << run.output;
}

TEST_F(BagReplay, ReportsAFileThatIsNotABag) {
  write("text.bag", "no bag at all");
  expect_refused("replay text.bag", {"text.bag", "is not a ROS 1 bag"});
}

}  // namespace
}  // namespace slalom::tools
