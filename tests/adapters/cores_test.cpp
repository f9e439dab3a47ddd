// The logic of the nodes and of the controller for nav2: refused options, paths and maps change nothing.
// The poses of sensors, stamps, and the file with the last pose.
#include "logic/localiser_core.hpp"
#include "logic/path_follower.hpp"
#include "logic/planner_core.hpp"
#include "logic/transforms.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom::nodes::cores_test {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

template <class Core>
std::string value_of(const Core& core, const std::string& option) {
  for (const NamedOption& each : core.options())
    if (each.name == option) return to_text(each.entry.value);
  return "no such option";
}

Clocks clocks() {
  return {[] { return 1000.0; }, [] { return 1000.0; }};
}

class PlannerCoreTest : public ::testing::Test {
 protected:
  PlannerCore core_{{.configuration = "", .method = "mppi"},
                    clocks(),
                    {},
                    {{},
                     {},
                     [this](const PlannerCore::Path&, bool closed) { paths_.push_back(closed); },
                     [](const std::string&) {},
                     {}}};
  std::vector<bool> paths_;  ///< whether each path that was taken is closed
};

TEST_F(PlannerCoreTest, AnInvalidOptionChangesNothing) {
  core_.change({{"mppi.samples", "64"}, {"planner.max_speed", "3"}});
  EXPECT_THROW(core_.change({{"mppi.samples", "128"}, {"mppi.horizon", "0"}}), std::exception);
  EXPECT_THROW(core_.change({{"mppi.samples", "128"}, {"mppi.none", "1"}}), std::exception);
  EXPECT_EQ(value_of(core_, "mppi.samples"), "64");
  EXPECT_EQ(value_of(core_, "planner.max_speed"), "3");
  EXPECT_THROW(PlannerCore({.configuration = "", .method = "none"}, clocks(), {}, {}), std::exception);
  EXPECT_THROW(PlannerCore({.configuration = "no/such/file.yaml", .method = "mppi"}, clocks(), {}, {}),
               std::exception);
}

TEST_F(PlannerCoreTest, AnInvalidPathIsIgnored) {
  core_.change({{"mppi.samples", "64"}});
  PlannerCore::Path line;
  for (int i = 0; i < 40; ++i) line.push_back({0.5 * i, 0, 0, 2});
  core_.hear_path({line[0], line[1]});
  EXPECT_TRUE(paths_.empty()) << "too short";
  core_.hear_path(line);
  line[7].x = unknown;
  core_.hear_path(line);
  EXPECT_EQ(paths_, std::vector<bool>{false});
  EXPECT_THROW(core_.drive_laps(1), std::exception) << "the path is open";
}

class LocaliserCoreTest : public ::testing::Test {
 protected:
  static maps::OccupancyGrid room() {
    maps::OccupancyGrid grid{40, 20, 0.1, {}, std::vector<maps::Occupancy>(800, maps::Occupancy::free)};
    for (int i = 0; i < 40; ++i) grid.at(i, 0) = maps::Occupancy::occupied;
    return grid;
  }

  LocaliserCore core_{{}, clocks(), {}, {{}, {}, {}, [](const std::string&) {}, [](const std::string&) {}}};
};

TEST_F(LocaliserCoreTest, AnInvalidMapOrOptionChangesNothing) {
  maps::OccupancyGrid torn = room(), flat = room();
  torn.cells.pop_back();
  flat.resolution = unknown;
  core_.hear_map(torn);
  EXPECT_EQ(core_.report().message, "no map");
  core_.hear_map(room());
  EXPECT_EQ(core_.report().message, "no scans");
  core_.hear_map(torn);
  core_.hear_map(flat);
  EXPECT_EQ(core_.report().message, "no scans");

  const std::string beams = value_of(core_, "beams");
  EXPECT_THROW(core_.change({{"beams", "20"}, {"min_particles", "0"}}), std::exception);
  EXPECT_THROW(core_.change({{"beams", "20"}, {"none", "1"}}), std::exception);
  EXPECT_EQ(value_of(core_, "beams"), beams);
}

TEST_F(LocaliserCoreTest, AChangeOfOptionsKeepsTheStartThatWasTold) {
  core_.hear_map(room());
  core_.hear_start({2, 1, 0.5});
  core_.change({{"beams", "20"}});
  const std::vector<maps::Pose> some = core_.particles(50);
  ASSERT_FALSE(some.empty());
  EXPECT_GT(core_.particles(std::numeric_limits<int>::max()).size(), some.size());
  for (const maps::Pose& each : some) {
    EXPECT_NEAR(each.x, 2, 1.5);
    EXPECT_NEAR(each.y, 1, 1.5);
    EXPECT_NEAR(each.yaw, 0.5, 1);
  }
}

TEST(FollowerOptions, HaveTheNamesOfMppiThatMeanTheSame) {
  const PathFollower follower;
  const std::vector<NamedOption> options = follower.options();
  const auto find = [&](const std::string& name) {
    const auto found = std::ranges::find(options, name, &NamedOption::name);
    return found == options.end() ? nullptr : &*found;
  };
  for (const char* name : {"temperature", "ax_max", "look_ahead", "patience", "costs.progress",
                           "svg_mppi.guides", "svg_mppi.seed"})
    EXPECT_NE(find(name), nullptr) << name;
  for (const NamedOption& each : options) EXPECT_STRNE(each.entry.declaration.help, "") << each.name;
  EXPECT_EQ(to_text(find("vx_max")->entry.value), "0.5");
  EXPECT_EQ(range_rule(find("vx_max")->entry.declaration), "must be in [0.01, 20]");
  EXPECT_EQ(to_text(find("time_steps")->entry.value), "56");
  EXPECT_EQ(find("motion_model")->entry.choices,
            (std::vector<std::string>{"DiffDrive", "Omni", "Ackermann"}));
  for (const char* name : {"base", "max_forward", "max_reverse", "horizon", "svg_mppi.horizon",
                           "svg_mppi.variance", "svg_mppi.input_max"})
    EXPECT_EQ(find(name), nullptr) << name << " follows from others or has another name";
  std::vector<std::string> names;
  for (const NamedOption& each : options) names.push_back(each.name);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end()) << "two of the same name";
}

TEST(FollowerOptions, AreRefusedWithTheirRuleAndThenNothingChanges) {
  PathFollower follower;
  const auto why = [&](const Changes& changes) {
    return message_of<std::exception>([&] { follower.change(changes); });
  };
  EXPECT_EQ(why({{"time_steps", "30"}, {"vx_max", "-3"}}), "vx_max: '-3' must be in [0.01, 20]");
  EXPECT_EQ(value_of(follower, "time_steps"), "56");
  EXPECT_EQ(why({{"motion_model", "boat"}}),
            "motion_model: 'boat' must be one of DiffDrive, Omni, Ackermann");
  EXPECT_EQ(why({{"vx_min", "0.1"}}), "vx_min: '0.1' must be in [-20, 0]");
  EXPECT_EQ(why({{"time_step", "30"}}), "time_step: unknown option, did you mean 'time_steps'?");
  EXPECT_NE(why({{"costs.none", "1"}}), "accepted");
  EXPECT_EQ(why({{"time_steps", "30"}, {"costs.path", "3"}, {"svg_mppi.guides", "2"}}), "accepted");
  EXPECT_EQ(value_of(follower, "time_steps"), "30");
  EXPECT_EQ(value_of(follower, "costs.path"), "3");
  EXPECT_THROW(PathFollower("none"), std::exception);
}

constexpr double quarter = std::numbers::pi / 2;  // rad

void expect_pose(const maps::Pose& pose, double x, double y, double yaw) {
  EXPECT_NEAR(pose.x, x, 1e-12);
  EXPECT_NEAR(pose.y, y, 1e-12);
  EXPECT_NEAR(pose.yaw, yaw, 1e-12);
}

TEST(Mount, OfAnUprightSensorIsAPoseInThePlane) {
  const Mount turned = mount_of(0.3, -0.1, 0.2, 0, 0, std::sin(quarter / 2), std::cos(quarter / 2));
  EXPECT_TRUE(turned.upright());
  expect_pose(turned.planar(), 0.3, -0.1, quarter);
  const double ahead_of_sensor[3] = {2, 0, 0}, up[3] = {0, 0, 3};
  EXPECT_NEAR(along(0, turned, ahead_of_sensor), 0, 1e-12);
  EXPECT_NEAR(along(1, turned, ahead_of_sensor), 2, 1e-12) << "it looks to the left of the car";
  EXPECT_NEAR(along(2, turned, up), 3, 1e-12);
}

TEST(Mount, OfASensorThatHangsUpsideDownIsNotUpright) {
  const Mount hanging = mount_of(0, 0, 0, 1, 0, 0, 0);  // turned by 180 degrees about x
  EXPECT_FALSE(hanging.upright());
  const double left[3] = {0, 1, 0}, up[3] = {0, 0, 3};
  EXPECT_NEAR(along(1, hanging, left), -1, 1e-12) << "its left is the right of the car";
  EXPECT_NEAR(along(2, hanging, up), -3, 1e-12);
}

TEST(StampTest, SurvivesTheWayThroughSeconds) {
  const Stamp stamp = 1'700'000'000'250'000'000;
  EXPECT_NEAR(static_cast<double>(stamp_of(in_seconds(stamp)) - stamp), 0, 300) << "ns";
  EXPECT_EQ(stamp_of(-0.5), -500'000'000);
}

TEST(KnownPoseTest, MovesAsTheOdometryDoes) {
  expect_pose(pose_now({{10, 20, 1 + quarter}, {3, 4, 1}}, {4, 4, 1.5}), 10, 21, 1.5 + quarter);
  // The odometry has started again.
  expect_pose(pose_now({{10, 20, 1}, {30, 40, 2}}, {0.1, 0, 0}), 10, 20, 1);
}

TEST(KnownPoseTest, IsReadFromAFileWhileItIsYoung) {
  const testing::ScopedFolder folder;
  const std::string file = folder.path() / "place";
  EXPECT_FALSE(read_pose(file, 1000)) << "there is none yet";
  ASSERT_TRUE(write_pose(file, {{1.25, -3.5, 0.1}, {7, 8, 0.9}}, 1000));
  const auto place = read_pose(file, 1009);
  ASSERT_TRUE(place);
  expect_pose(place->map, 1.25, -3.5, 0.1);
  expect_pose(place->odometry, 7, 8, 0.9);
  EXPECT_FALSE(read_pose(file, 1011)) << "too old";
  EXPECT_FALSE(read_pose(file, 999)) << "from the future";
  std::ofstream(file) << "1.25 -3.5";
  EXPECT_FALSE(read_pose(file, 1001)) << "cut";
  std::ofstream(file) << "1.25 -3.5 nan 0 0 0 1000";
  EXPECT_FALSE(read_pose(file, 1001)) << "not finite";
  EXPECT_FALSE(write_pose(folder.path() / "none" / "place", {}, 1000));
}

}  // namespace

}  // namespace slalom::nodes::cores_test
