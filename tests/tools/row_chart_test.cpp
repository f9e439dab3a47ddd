// Charts of rows: names stay left of the panels.
// Progress lines never promise a time that is over.
// JSON that is read from files: limits, and errors that name the key.
// Settings of an evaluation that no evaluation has are refused by name; from the others its laps are made
// again.
// A navigator in its room, as the live view drives it: what is dragged, options, and copies.
#include <gtest/gtest.h>

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/maps/image.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"
#include "tools/drawing/row_chart.hpp"
#include "tools/evaluation/evaluation_job.hpp"
#include "tools/evaluation/stored_evaluation.hpp"
#include "tools/live_view/view_setup.hpp"
#include "tools/terminal/progress.hpp"

namespace slalom::tools {
namespace {

class RowChartPicture : public testing::TemporaryFolder {};

TEST_F(RowChartPicture, LongNamesDoNotReachThePanels) {
  RowChart chart;
  chart.names = {"svg_mppi",
                 "svg_mppi, svg_mppi.gradient_variance=0.01,4, svg_mppi.restart_standard_deviation=0.3",
                 "svg_mppi, svg_mppi.sample_around=solution, vehicle.terminal_distance_weight=200, "
                 "planner.profile_friction=0.7, world.range_noise=0.02"};
  Panel panel{.title = "cost", .axis = "cost", .kind = Panel::Kind::bars, .ours = {}, .theirs = {}};
  panel.ours.assign(3, {.values = {}, .span = Span{2, 1.5, 3}});
  chart.panels = {panel};
  save(draw_chart(chart), folder_ / "chart.png", 1);
  const maps::GreyImage image = maps::load_image(folder_ / "chart.png");
  constexpr int first_row = 44 + 62, rows_end = first_row + 3 * 42, names_end = 18 + 250 - 12;
  int ink = 0, beside = 0;
  for (int y = first_row; y < rows_end; ++y)
    for (int x = 0; x < 18 + 250 - 4; ++x)
      if (image.grey[static_cast<std::size_t>(y * image.width + x)] < 200) ++(x < names_end ? ink : beside);
  EXPECT_GT(ink, 1000);
  EXPECT_EQ(beside, 0);
}

TEST(ProgressText, NoTimeIsLeftThatIsNotKnownOrOver) {
  const auto text = [](int done, double left) {
    return evaluation_text({.laps_done = done, .laps_total = 10, .seconds_left = left});
  };
  EXPECT_EQ(text(0, 0), "0 of 10 laps");
  EXPECT_EQ(text(5, 62), "5 of 10 laps, 1 min 02 s left");
  EXPECT_EQ(text(9, 0.2), "9 of 10 laps, 1 s left");
  EXPECT_EQ(text(10, 0), "10 of 10 laps");
}

TEST(Json, ErrorsSayWhereTheTextIsWrong) {
  const std::string error = message_of([] { parse_json("{\n\"a\": ]"); });
  EXPECT_EQ(error.rfind("is not JSON: parse error at line 2, column 6", 0), 0u) << error;
  EXPECT_THROW(parse_json(std::string(100000, '[')), std::invalid_argument);
  EXPECT_TRUE(parse_json_or_null("{").is_null());
  EXPECT_TRUE(parse_json(std::string(64, '[') + std::string(64, ']')).is_array());
}

TEST(Json, MembersAreCheckedAndErrorsNameTheKey) {
  const Json json = parse_json(R"({"large": 4294967298, "half": 2.5, "less": -1, "text": "a"})");
  EXPECT_EQ(member<std::uint64_t>(json, "large"), 4294967298U);
  EXPECT_EQ(member<int>(json, "less"), -1);
  EXPECT_DOUBLE_EQ(member<double>(json, "less"), -1);
  EXPECT_EQ(member<std::string>(json, "text"), "a");
  EXPECT_EQ(message_of([&] { member<int>(json, "none"); }), "key 'none' is missing");
  EXPECT_EQ(message_of([&] { member<double>(json, "text"); }), "key 'text': \"a\" must be a number");
  for (const char* key : {"large", "half", "text"})
    EXPECT_THROW(member<int>(json, key), std::invalid_argument) << key;
  EXPECT_THROW(member<std::uint64_t>(json, "less"), std::invalid_argument);
  EXPECT_THROW(member<int>(Json::array(), "large"), std::invalid_argument);
}

TEST(Json, BytesThatAreNotUtf8AreReplaced) {
  EXPECT_EQ(json_text("a\xff"), "\"a\xEF\xBF\xBD\"");
}

class StoredSettings : public testing::TemporaryFolder {
 protected:
  /// The error message for a folder without laps whose settings have these experiments and this seed.
  std::string complaint(const std::string& experiments, const std::string& seed0 = "0") const {
    write("laps.csv", evaluation::checked_header() + "\n");
    write("settings.json",
          evaluation::with_checksum("{\"experiments\": [" + experiments + "], \"seed0\": " + seed0 + "}"));
    return message_of<IoError>([&] { load_evaluation(folder_); });
  }
  static std::string experiment(const std::string& laps) {
    return R"({"method": "mppi", "set": "", "scenario": "oa", "obstacles": 5, "laps": )" + laps + "}";
  }
};

TEST_F(StoredSettings, NeedAnExperiment) {
  EXPECT_EQ(complaint(experiment("3")), "accepted");
  EXPECT_NE(complaint("").find("settings.json: is invalid: experiments: must be at least one"),
            std::string::npos);
}

TEST_F(StoredSettings, WholeNumbersAreNotCutToFit) {
  EXPECT_NE(complaint(experiment("4294967298")).find("4294967298"), std::string::npos);
  EXPECT_NE(complaint(experiment("0")).find("laps: 0 must be in [1, 1000000]"), std::string::npos);
  EXPECT_NE(complaint(experiment("3"), "1e30").find("must be a whole number"), std::string::npos);
}

using view::ShapeKind;
using view::SolverSubject;

/// A drive of a subject.
struct Drive {
  explicit Drive(const std::string& scenario) : subject(room_subject(scenario, "svg_mppi", 1)) {}

  void decide() {
    status = subject->facts().statuses.at(
        static_cast<std::size_t>(subject->status(subject->solve(state, {.elapsed = elapsed}))));
  }
  /// Drives up to `steps` steps, until a status.
  bool drive(int steps, const std::string& until = "") {
    for (int i = 0; i < steps; ++i) {
      decide();
      if (status == until) return true;
      const auto inputs = subject->inputs().first(subject->facts().inputs.size());
      state = subject->step(state, inputs);
      elapsed = subject->time_step();
    }
    return false;
  }
  int goal() const {
    const auto shapes = subject->shapes();
    const auto is_goal = [](const view::Shape& each) { return each.kind == ShapeKind::goal; };
    return static_cast<int>(std::ranges::find_if(shapes, is_goal) - shapes.begin());
  }

  std::unique_ptr<SolverSubject> subject;
  std::vector<double> state = subject->start();
  double elapsed = 0;
  std::string status;
};

TEST(RoomSubject, ACopyContinuesBitForBit) {
  Drive one("crowd-crossing");
  one.drive(60);
  Drive other("crowd-crossing");
  other.subject.reset(static_cast<SolverSubject*>(one.subject->clone().release()));
  other.state = one.state;
  other.elapsed = one.elapsed;
  one.drive(40);
  other.drive(40);
  EXPECT_EQ(one.state, other.state);
  EXPECT_GT(one.state[0], one.subject->start()[0] + 1);
}

TEST(RoomSubject, TheGoalIsDraggedAndReachedAndTheRoomBeginsAnew) {
  Drive drive("heading");
  drive.drive(20);
  const maps::Pose goal = drive.subject->shapes()[static_cast<std::size_t>(drive.goal())].pose;
  const maps::Point to{goal.x - 1, goal.y + 0.5};
  drive.subject->move(drive.goal(), {to.x, to.y, 0});
  ASSERT_TRUE(drive.drive(900, "goal_reached")) << drive.status;
  EXPECT_LT(std::hypot(drive.state[0] - to.x, drive.state[1] - to.y), 0.15);
  // Without a plan the robot stands, and its trajectories do.
  const std::vector<float> still(drive.subject->facts().inputs.size());
  const Trajectories all = drive.subject->roll_out(drive.state, still);
  EXPECT_EQ(drive.subject->poses(all.states).back().x, drive.state[0]);
  // The goal that was dragged stays after a restart.
  drive.subject->restart();
  EXPECT_EQ(drive.subject->shapes()[static_cast<std::size_t>(drive.goal())].pose.x, to.x);
}

TEST(RoomSubject, AGoalInAWallIsRefusedAndPeopleAreNotDragged) {
  Drive drive("crowd-crossing");
  drive.drive(5);
  EXPECT_THROW(drive.subject->move(drive.goal(), {-1, -1, 0}), std::invalid_argument);
  EXPECT_THROW(drive.subject->move(drive.goal() + 1, {2, 2, 0}), std::invalid_argument);
  EXPECT_FALSE(drive.drive(20, "no_path"));
}

TEST(RoomSubject, AnObstacleThatIsDraggedIntoTheWayIsPassedOnADetour) {
  Drive drive("pallet-on-path");
  const maps::Pose pallet = drive.subject->shapes()[0].pose;
  drive.subject->move(0, {pallet.x, pallet.y + 100, 0});  // out of the room
  EXPECT_FALSE(drive.drive(40, "detour"));
  drive.subject->move(0, {pallet.x, pallet.y, 0});
  EXPECT_TRUE(drive.drive(200, "detour")) << drive.status;
  EXPECT_TRUE(drive.drive(900, "goal_reached")) << drive.status;
}

TEST(RoomSubject, OptionsOfMethodAndNavigatorChange) {
  Drive drive("heading");
  drive.drive(10);
  EXPECT_TRUE(drive.subject->set_parameter("problem", "max_forward", "0.2"));
  EXPECT_THROW(drive.subject->set_parameter("problem", "max_forward", "-1"), std::invalid_argument);
  EXPECT_FALSE(drive.subject->set_parameter("problem", "base", "ackermann"));
  drive.subject->set_options(*drive.subject->options_of("mppi"));
  EXPECT_STREQ(drive.subject->options()->method(), "mppi");
  drive.drive(40);
  EXPECT_LT(drive.state[3], 0.21);
  EXPECT_GT(drive.state[3], 0.1);
}

TEST(RoomSubject, TheTrajectoryOfThePlanIsWhatTheSolverPredicts) {
  Drive drive("pallet-on-path");
  drive.drive(30);
  const SolveResult& solve = drive.subject->solve(drive.state, {.elapsed = 0.05});
  const std::vector<float> plan(solve.inputs.begin(), solve.inputs.end());
  const Trajectories all = drive.subject->roll_out(drive.state, plan);
  const auto poses = drive.subject->poses(all.states);
  EXPECT_NEAR(poses.front().x, drive.state[0], 1e-9);
  EXPECT_GT(poses.back().x, poses.front().x + 0.3);
  EXPECT_EQ(all.costs.size(), poses.size() * drive.subject->facts().terms.size());
}

TEST(RoomSubject, AnUnknownScenarioIsRefusedWithTheNames) {
  expect_error_with<std::invalid_argument>({"crowd-crossing"},
                                           [] { room_subject("nowhere", "svg_mppi", 1); });
}

}  // namespace

}  // namespace slalom::tools
