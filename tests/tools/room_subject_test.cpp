// A navigator in its room, as the live view drives it: what is dragged, options, and copies.
#include "tools/live_view/view_setup.hpp"

#include "support/thrown_words.hpp"

namespace slalom::tools {
namespace {

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
