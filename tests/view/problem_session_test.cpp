// Commands to the drive of an own problem: going back, changes that fail, other durations of steps.
#include "view/problem/problem_session.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>

#include "slalom/problems/differential_drive.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/view/serve.hpp"
#include "view/web_client.hpp"

namespace slalom::view {
namespace {

using nlohmann::json;
using problems::DifferentialDrive;
using State = DifferentialDrive::State<double>;

/// A robot among discs, paused at its first step. A disc that is moved beyond x = 50 m cannot be drawn.
class OwnProblem : public ::testing::Test {
 protected:
  OwnProblem() {
    session_.turn({});
    tell({R"({"do": "pause"})"});
  }

  /// Sends commands, which arrive together, and turns the session `turns` times.
  void tell(const std::vector<std::string>& commands, int turns = 1) {
    const auto before = server_.counters().messages;
    for (const std::string& command : commands) client_.send_message(command);
    for (int i = 0; i < 5000 && server_.counters().messages < before + commands.size(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    for (int i = 0; i < turns; ++i) session_.turn({});
  }
  /// A figure of a step; NaN if the step is not known.
  double figure(const std::string& name, int tick) {
    const std::string at = std::to_string(tick);
    tell({R"({"do": "past", "from": )" + at + R"(, "to": )" + at + "}"});
    for (;;) {
      const std::string message = client_.next_message();
      double value = std::numeric_limits<double>::quiet_NaN();
      if (message.empty()) return value;
      if (!message.starts_with("SLV1")) {
        const json parsed = json::parse(message);
        last_[parsed["type"]] = parsed;
      } else if (message[4] == static_cast<char>(Block::past)) {
        const std::vector<std::string> names = last_["hello"]["scalars"];
        const auto i = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
        if (message.size() >= 20 + 8 * i) std::memcpy(&value, &message[12 + 8 * i], sizeof value);
        return value;
      }
    }
  }
  /// The last message of a type, while the drive is paused.
  json last(const char* type) {
    tell({R"({"do": "pause"})"});
    figure("tick", 0);
    return last_[type];
  }
  /// The value of an option that the page has.
  std::string option(const std::string& section, const std::string& name) {
    const json options = last("options");
    for (const json& each : options["sections"])
      for (const json& one : each["options"])
        if (each["name"] == section && one["name"] == name) return one["value"];
    return "none";
  }

  std::unique_ptr<Subject> subject() {
    SolverOptions options = solver_options("svg_mppi");
    *options.find<int>("samples") = 128;
    *options.find<PerInput>("input_min") = {0, -2};
    *options.find<PerInput>("input_max") = {1.5, 2};
    Drawing<DifferentialDrive> drawing{.x = &State::x, .y = &State::y, .heading = &State::yaw};
    drawing.shapes = [](const DifferentialDrive& p) {
      if (p.discs[0].x > 50) throw std::runtime_error("the disc is too far away");
      return std::vector{disc(p.discs[0].x, p.discs[0].y, p.discs[0].radius)};
    };
    drawing.move = [this](DifferentialDrive& p, int, const maps::Point& to) {
      ++moves_;
      p.discs[0].x = to.x, p.discs[0].y = to.y;
    };
    return std::make_unique<detail::ControllerSubject<DifferentialDrive>>(
        Controller<DifferentialDrive>(DifferentialDrive{}, options), std::move(drawing));
  }

  int moves_ = 0;  ///< calls of the drawing's `move`
  Server server_{{.messages_per_second = 1e6, .burst = 1e6}, {}};
  testing::PageClient client_{server_};
  ProblemSession session_{subject(), server_};
  std::map<std::string, json> last_;  ///< the last message of each type
};

TEST_F(OwnProblem, ACommandWithAWrongValueChangesNothing) {
  tell({R"({"do": "rate", "rate": 1e9})"});
  EXPECT_EQ(last("error")["message"], "rate: must be 0 for the maximum speed, or in [0.001, 100]");
  EXPECT_EQ(last("state")["rate"], 1);
  tell({R"({"do": "step", "ticks": 3})"}, 3);
  tell({R"({"do": "seek", "tick": 1})", R"({"do": "step", "ticks": "many"})"});
  EXPECT_EQ(last("state")["newest"], 3);
  EXPECT_EQ(last("state")["tick"], 1);
}

TEST_F(OwnProblem, StepsAddUpAndAPauseEndsThem) {
  tell({R"({"do": "step", "ticks": 3})", R"({"do": "step", "ticks": 4})"}, 9);
  EXPECT_EQ(last("state")["newest"], 7);
  tell({R"({"do": "step", "ticks": 3})", R"({"do": "pause"})"}, 3);
  EXPECT_EQ(last("state")["newest"], 7);
}

TEST_F(OwnProblem, OptionsAreThoseOfTheStepThatIsShown) {
  tell({R"({"do": "step", "ticks": 3})"}, 3);
  tell({R"({"do": "set", "key": "svg_mppi.samples", "value": "64"})"});
  tell({R"({"do": "step", "ticks": 3})"}, 3);
  tell({R"({"do": "method", "method": "mppi"})"});
  EXPECT_EQ(option("mppi", "samples"), "64");
  tell({R"({"do": "seek", "tick": 4})"});
  EXPECT_EQ(option("svg_mppi", "samples"), "64");
  EXPECT_EQ(last("state")["method"], "svg_mppi");
  tell({R"({"do": "seek", "tick": 1})"});
  EXPECT_EQ(option("svg_mppi", "samples"), "128");
  tell({R"({"do": "set", "key": "svg_mppi.samples", "value": "4194304"})"});
  EXPECT_NE(last("error")["message"].get<std::string>().find("in the live view"), std::string::npos);
}

TEST_F(OwnProblem, TheNumberOfCollisionsIsThatOfTheStep) {
  tell({R"({"do": "place_car", "x": 2.5, "y": 0})"});
  tell({R"({"do": "step", "ticks": 3})"}, 3);
  EXPECT_EQ(figure("contacts", 0), 1);
  EXPECT_EQ(figure("contacts", 3), 4);
  tell({R"({"do": "seek", "tick": 2})"});
  tell({R"({"do": "step"})"});
  EXPECT_EQ(figure("contacts", 3), 4);
}

TEST_F(OwnProblem, AnotherDurationOfStepsBeginsAnew) {
  tell({R"({"do": "step", "ticks": 5})"}, 5);
  const json before = last("state");
  tell({R"({"do": "set", "key": "problem.dt", "value": "0.2"})"});
  const json state = last("state");
  EXPECT_EQ(state["control_period"], 0.2);
  EXPECT_EQ(state["newest"], 0);
  EXPECT_EQ(state["paused"], true);
  EXPECT_EQ(state["generation"], before["generation"].get<int>() + 1);
  tell({R"({"do": "step"})"});
  EXPECT_EQ(figure("time", 1), 0.2);
}

TEST_F(OwnProblem, AChangeThatFailsChangesNothing) {
  tell({R"({"do": "step", "ticks": 3})"}, 3);
  const double cost = figure("minimum_cost", 3);
  tell({R"({"do": "move", "body": 1, "x": 99, "y": 0})"});
  EXPECT_EQ(last("error")["message"], "the disc is too far away");
  EXPECT_EQ(last("state")["edited"], false);
  EXPECT_EQ(figure("minimum_cost", 3), cost);
  tell({R"({"do": "move", "body": 2, "x": 1, "y": 0})"});
  EXPECT_EQ(last("error")["message"], "body: must be a shape of the scene");
  tell({R"({"do": "step"})"});
  EXPECT_EQ(figure("tick", 4), 4);
}

TEST_F(OwnProblem, OnlyTheLastStepOfADragIsPlannedFor) {
  const std::string move = R"({"do": "move", "body": 1, "y": 1, "drag": 7, "x": )";
  tell({move + "3}", move + "3.5}", move + "4}"});
  EXPECT_EQ(last("state")["edited"], true);
  EXPECT_EQ(moves_, 1);
  const std::string place = R"({"do": "place_car", "y": 0, "x": )";
  tell({place + "-90}", place + "-1}"});
  EXPECT_EQ(figure("x", 0), -1);
  EXPECT_GT(last("state")["bounds"][0], -10) << "the first place was not drawn";
}

TEST_F(OwnProblem, ResetsWhatWasChangedAlsoWithAnotherMethod) {
  tell({R"({"do": "set", "key": "svg_mppi.samples", "value": "64"})"});
  tell({R"({"do": "set", "key": "problem.goal_x", "value": "6"})"});
  tell({R"({"do": "method", "method": "mppi"})"});
  tell({R"({"do": "reset_options"})"});
  EXPECT_EQ(option("mppi", "samples"), "128");
  EXPECT_EQ(option("problem", "goal_x"), "8");
  EXPECT_EQ(last("options")["changed"], json::array());
  EXPECT_EQ(figure("samples", 0), 128);
}

}  // namespace
}  // namespace slalom::view
