// Commands to the drive of an own problem: going back, changes that fail, other durations of steps.

#include "slalom/problems/differential_drive.hpp"
#include "slalom/solvers/controllers.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/view/serve.hpp"
#include "view/paused_session.hpp"

namespace slalom::view {
namespace {

using problems::DifferentialDrive;
using State = DifferentialDrive::State<double>;

int moves = 0;  // calls of the drawing's `move`

/// A place on a line that is to follow a goal, which moves with the time.
struct Follower {
  template <class T>
  struct State {
    T x;
  };
  static constexpr int inputs = 1;
  double dt = 0.1, goal = 0;
  template <class T>
  State<T> step(const State<T>& x, const Input<T, 1>& u) const {
    return {x.x + T(dt) * u[0]};
  }
  template <class T>
  T stage_cost(const State<T>& x, const Input<T, 1>&) const {
    return (x.x - T(goal)) * (x.x - T(goal));
  }
};

/// A robot among discs. A disc that is moved beyond x = 50 m cannot be drawn.
std::unique_ptr<Subject> robot() {
  SolverOptions options = solver_options("svg_mppi");
  *options.find<int>("samples") = 128;
  *options.find<PerInput>("input_min") = {0, -2};
  *options.find<PerInput>("input_max") = {1.5, 2};
  Drawing<DifferentialDrive> drawing{.x = &State::x, .y = &State::y, .heading = &State::yaw};
  drawing.shapes = [](const DifferentialDrive& p) {
    if (p.discs[0].x > 50) throw std::runtime_error("the disc is too far away");
    return std::vector{disc(p.discs[0].x, p.discs[0].y, p.discs[0].radius)};
  };
  drawing.move = [](DifferentialDrive& p, int, const maps::Point& to) {
    ++moves;
    p.discs[0].x = to.x, p.discs[0].y = to.y;
  };
  return std::make_unique<detail::ControllerSubject<DifferentialDrive>>(
      Controller<DifferentialDrive>(DifferentialDrive{}, options), std::move(drawing));
}

class OwnProblem : public ::testing::Test, protected PausedSession {
 protected:
  OwnProblem() : PausedSession(robot()) { moves = 0; }
};

class MovingGoal : public ::testing::Test, protected PausedSession {
 protected:
  MovingGoal() : PausedSession(follower(), {.against = "mppi"}) {}
  static std::unique_ptr<Subject> follower() {
    Drawing<Follower> drawing{.pose = [](const Follower::State<double>& x) { return maps::Pose{x.x, 0, 0}; }};
    drawing.shapes = [](const Follower& p) { return std::vector{disc(p.goal, 1, 0.1, ShapeKind::goal)}; };
    drawing.clock = [](Follower& p, double time) { p.goal = 10 * time; };
    return std::make_unique<detail::ControllerSubject<Follower>>(
        SvgMppi{Follower{}, {.horizon = 10, .samples = 64, .input_min = {-5}, .input_max = {5}}},
        std::move(drawing));
  }
  /// The place of the goal in a frame, m.
  double goal(int tick) {
    const std::string frame = this->frame(tick);
    PayloadReader bodies(FrameReader(frame).block(Block::bodies));
    bodies.take(4 + 24 + 4);
    return bodies.f32();
  }
};

TEST_F(MovingGoal, GoesWithTheClockOfTheDriveAlsoInThePast) {
  step(8);
  EXPECT_NEAR(goal(0), 0, 1e-6);
  EXPECT_NEAR(goal(8), 8, 1e-5);
  say({R"({"do": "seek", "tick": 3})"});
  continue_here();
  step(2);
  EXPECT_NEAR(goal(5), 5, 1e-5);
  say({R"({"do": "restart"})"});
  EXPECT_NEAR(goal(0), 0, 1e-6);
}

TEST_F(MovingGoal, HasASecondMethodFromTheStartAndNoCollisions) {
  step(2);
  EXPECT_EQ(last("state")["ghost"], "mppi");
  EXPECT_TRUE(std::isnan(figure("contacts", 1))) << "a state of this problem cannot collide";
  EXPECT_FALSE(std::isnan(ghost_figure("x", 2)));
}

TEST_F(OwnProblem, ACommandWithAWrongValueChangesNothing) {
  say({R"({"do": "rate", "rate": 1e9})"});
  EXPECT_EQ(last("error")["message"], "rate: must be 0 for the maximum speed, or in [0.001, 100]");
  EXPECT_EQ(last("state")["rate"], 1);
  step(3);
  say({R"({"do": "seek", "tick": 1})", R"({"do": "step", "ticks": "many"})"});
  EXPECT_EQ(last("state")["newest"], 3);
  EXPECT_EQ(last("state")["tick"], 1);
}

TEST_F(OwnProblem, StepsAddUpAndAPauseEndsThem) {
  say({R"({"do": "step", "ticks": 3})", R"({"do": "step", "ticks": 4})"});
  EXPECT_EQ(last("state")["newest"], 7);
  say({R"({"do": "step", "ticks": 3})", R"({"do": "pause"})"});
  EXPECT_EQ(last("state")["newest"], 7);
}

TEST_F(OwnProblem, AStepShowsWhatWasDrivenAndOnlyPlayForgetsIt) {
  step(6);
  say({R"({"do": "seek", "tick": 2})", R"({"do": "step", "ticks": 3})"});
  EXPECT_EQ(last("state")["tick"], 5);
  EXPECT_EQ(last("state")["newest"], 6);
  say({R"({"do": "step", "ticks": 3})"});
  EXPECT_EQ(last("state")["newest"], 8) << "one that was driven, and two more";
  say({R"({"do": "seek", "tick": 2})"});
  continue_here();
  EXPECT_EQ(last("state")["newest"], 2);
}

TEST_F(OwnProblem, OptionsAreThoseOfTheStepThatIsShown) {
  step(3);
  say({R"({"do": "set", "key": "svg_mppi.samples", "value": "64"})"});
  step(3);
  say({R"({"do": "method", "method": "mppi"})"});
  EXPECT_EQ(option("mppi", "samples"), "64");
  say({R"({"do": "seek", "tick": 4})"});
  EXPECT_EQ(option("svg_mppi", "samples"), "64");
  EXPECT_EQ(last("state")["method"], "svg_mppi");
  say({R"({"do": "seek", "tick": 1})"});
  EXPECT_EQ(option("svg_mppi", "samples"), "128");
  say({R"({"do": "set", "key": "svg_mppi.samples", "value": "4194304"})"});
  EXPECT_NE(last("error")["message"].get<std::string>().find("in the live view"), std::string::npos);
}

TEST_F(OwnProblem, TheNumberOfCollisionsIsThatOfTheStep) {
  say({R"({"do": "place_car", "x": 2.5, "y": 0})"});
  step(3);
  EXPECT_EQ(figure("contacts", 0), 1);
  EXPECT_EQ(figure("contacts", 3), 4);
  say({R"({"do": "seek", "tick": 2})"});
  say({R"({"do": "step"})"});
  EXPECT_EQ(figure("contacts", 3), 4);
}

TEST_F(OwnProblem, AnotherDurationOfStepsBeginsAnew) {
  step(5);
  const json before = last("state");
  say({R"({"do": "set", "key": "problem.dt", "value": "0.2"})"});
  const json state = last("state");
  EXPECT_EQ(state["control_period"], 0.2);
  EXPECT_EQ(state["newest"], 0);
  EXPECT_EQ(state["paused"], true);
  EXPECT_EQ(state["generation"], before["generation"].get<int>() + 1);
  say({R"({"do": "step"})"});
  EXPECT_EQ(figure("time", 1), 0.2);
}

TEST_F(OwnProblem, AChangeThatFailsChangesNothing) {
  step(3);
  const double cost = figure("minimum_cost", 3);
  say({R"({"do": "move", "body": 1, "x": 99, "y": 0})"});
  EXPECT_EQ(last("error")["message"], "the disc is too far away");
  EXPECT_EQ(last("state")["edited"], false);
  EXPECT_EQ(figure("minimum_cost", 3), cost);
  say({R"({"do": "move", "body": 2, "x": 1, "y": 0})"});
  EXPECT_EQ(last("error")["message"], "body: must be a shape of the scene");
  say({R"({"do": "step"})"});
  EXPECT_EQ(figure("tick", 4), 4);
}

TEST_F(OwnProblem, OnlyTheLastStepOfADragIsPlannedFor) {
  const std::string move = R"({"do": "move", "body": 1, "y": 1, "drag": 7, "x": )";
  say({move + "3}", move + "3.5}", move + "4}"});
  EXPECT_EQ(last("state")["edited"], true);
  EXPECT_EQ(moves, 1);
  const std::string place = R"({"do": "place_car", "y": 0, "x": )";
  say({place + "-90}", place + "-1}"});
  EXPECT_EQ(figure("x", 0), -1);
  EXPECT_GT(last("state")["bounds"][0], -10) << "the first place was not drawn";
}

TEST_F(OwnProblem, ResetsWhatWasChangedAlsoWithAnotherMethod) {
  say({R"({"do": "set", "key": "svg_mppi.samples", "value": "64"})"});
  say({R"({"do": "set", "key": "svg_mppi.samples", "value": "-5"})"});
  EXPECT_EQ(last("error")["message"], "svg_mppi.samples: '-5' must be in [1, 4194304]");
  say({R"({"do": "set", "key": "problem.goal_x", "value": "6"})"});
  say({R"({"do": "method", "method": "mppi"})"});
  say({R"({"do": "reset_options"})"});
  EXPECT_EQ(option("mppi", "samples"), "128");
  EXPECT_EQ(option("problem", "goal_x"), "8");
  EXPECT_EQ(last("options")["changed"], json::array());
  EXPECT_EQ(figure("samples", 0), 128);
}

TEST_F(OwnProblem, AGhostDrivesBesideOnTheSameScene) {
  const auto can = last("hello")["can"];
  EXPECT_NE(std::ranges::find(can, "ghost"), can.end());
  step(3);
  say({R"({"do": "ghost", "method": "mppi"})"});
  EXPECT_EQ(last("state")["ghost"], "mppi");
  EXPECT_EQ(ghost_figure("x", 3), figure("x", 3)) << "it starts where the robot is";
  step(6);
  const double x = figure("x", 9), ghost = ghost_figure("x", 9);
  EXPECT_NE(ghost, x);
  const json methods = last("hello")["methods"];
  EXPECT_EQ(methods[static_cast<std::size_t>(ghost_figure("method", 9))], "mppi");
  say({R"({"do": "place_car", "x": -1, "y": 0})"});
  EXPECT_EQ(figure("x", 9), -1);
  EXPECT_EQ(ghost_figure("x", 9), ghost) << "only the robot is put elsewhere";
  say({R"({"do": "move", "body": 1, "x": 3, "y": 1})"});
  EXPECT_EQ(moves, 2) << "the disc in both scenes";
  say({R"({"do": "seek", "tick": 6})"});
  step_to(9);
  EXPECT_EQ(figure("x", 9), x);
  EXPECT_EQ(ghost_figure("x", 9), ghost) << "both are driven again exactly";
  say({R"({"do": "restart"})"});
  EXPECT_EQ(last("state")["ghost"], "mppi");
  EXPECT_EQ(ghost_figure("x", 0), figure("x", 0));
  say({R"({"do": "ghost", "method": ""})"});
  EXPECT_TRUE(std::isnan(ghost_figure("x", 0)));
}

TEST_F(OwnProblem, AForkContinuesWithOtherOptionsBesideWhatDroveBefore) {
  step(3);
  const double x = (step(4), figure("x", 7));
  say({R"({"do": "seek", "tick": 3})",
       R"({"do": "fork", "method": "svg_mppi", "set": ["samples=64", "problem.goal_x=-8"]})"});
  EXPECT_EQ(last("state")["ghost_label"], "svg_mppi as before");
  const double samples = figure("samples", 3);
  EXPECT_EQ(option("problem", "goal_x"), "-8");
  step(4);
  EXPECT_GT(ghost_figure("samples", 7), samples) << "of the last batch";
  EXPECT_EQ(last("state")["newest"], 7);
  EXPECT_NE(figure("x", 7), x);
  say({R"({"do": "fork", "method": "svg_mppi", "set": ["problem.dt=0.2"]})"});
  EXPECT_EQ(last("error")["message"], "fork: the control period cannot change during a drive");
  say({R"({"do": "undo"})"});
  EXPECT_EQ(option("problem", "goal_x"), "8");
  EXPECT_EQ(option("svg_mppi", "samples"), "128");
}

TEST_F(OwnProblem, UndoesAndRedoesOptionsMethodsAndObstacles) {
  const std::string move = R"({"do": "move", "body": 1, "y": 1, "drag": 7, "x": )";
  const double before = figure("minimum_cost", 0);
  say({move + "3}"});
  say({move + "2}"});
  const double moved = figure("minimum_cost", 0);
  say({R"({"do": "set", "key": "problem.goal_x", "value": "6"})"});
  say({R"({"do": "method", "method": "mppi"})"});
  EXPECT_EQ(last("options")["undo"], 3) << "a drag is one change";
  say({R"({"do": "undo"})"});
  EXPECT_EQ(last("state")["method"], "svg_mppi");
  EXPECT_EQ(option("problem", "goal_x"), "6");
  say({R"({"do": "undo"})"});
  EXPECT_EQ(option("problem", "goal_x"), "8");
  say({R"({"do": "undo"})"});
  EXPECT_EQ(last("options")["undo"], 0);
  say({R"({"do": "redo"})", R"({"do": "redo"})"});
  EXPECT_EQ(option("problem", "goal_x"), "6");
  EXPECT_NE(moved, before);
  say({R"({"do": "undo"})", R"({"do": "undo"})", R"({"do": "undo"})"});
  EXPECT_EQ(last("error")["message"], "nothing to undo");
}

}  // namespace
}  // namespace slalom::view
