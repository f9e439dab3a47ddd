// Commands to a session: the drive of the command line, going back exactly, edits, options.
#include "view/session_fixture.hpp"

#include <cmath>

#include "view/protocol/frame_reader.hpp"

namespace slalom::view {
namespace {

TEST_F(ViewSession, FirstMessagesHoldWhatThePageNeeds) {
  const json hello = next("hello");
  EXPECT_EQ(hello["protocol"], 2);
  EXPECT_EQ(hello["terms"].size(), 3u);
  EXPECT_GT(hello["body"]["front"], 0) << "a car has wheels";
  EXPECT_EQ(hello["scalars"].size(), car_scalars().size());
  EXPECT_EQ(hello["courses"], (json{"stag", "eel"}));
  const json options = next("options");
  ASSERT_EQ(options["sections"][0]["name"], "svg_mppi");
  bool samples = false;
  for (const json& each : options["sections"][0]["options"])
    if (each["name"] == "samples") {
      samples = true;
      EXPECT_EQ(each["value"], "128");
      EXPECT_EQ(each["type"], "integer");
      EXPECT_EQ(each["min"], 1);
      EXPECT_EQ(each["symbol"], "K");
    }
  EXPECT_TRUE(samples);
}

TEST_F(ViewSession, TellsTheSymptomOfTheSolver) {
  const json symptoms = next("hello")["symptoms"];
  EXPECT_EQ(scalar(step_to(30), "symptom"), 0);
  tell({{"do", "set"}, {"key", "svg_mppi.temperature"}, {"value", "1e-6"}});
  const auto symptom = static_cast<std::size_t>(scalar(step_to(60), "symptom"));
  EXPECT_EQ(symptoms[symptom]["name"], "few_samples");
  EXPECT_NE(symptoms[symptom]["explanation"].get<std::string>().find("raise it"), std::string::npos);
}

TEST_F(ViewSession, DrivesTheLapOfTheCommandLine) {
  // The session first: its client does not stay for as long as a lap may take.
  const std::string fifth = step_to(5);
  EXPECT_EQ(FrameReader(fifth).block(Block::scalars).size(), 8 * car_scalars().size());
  const double x5 = scalar(fifth, "x"), x60 = scalar(step_to(60), "x");
  const evaluation::LapSetup setup{environment_of("stag"), {small()}, {.obstacles = 2}};
  std::vector<double> x;
  run_lap(setup, 4, [&](const evaluation::ControlStep& tick) { x.push_back(tick.seen.pose.x); });
  EXPECT_EQ(x5, x[5]);
  EXPECT_EQ(x60, x[60]);
}

TEST_F(ViewSession, RestoresAnEarlierStateExactly) {
  step_to(20);
  tell({{"do", "add"}, {"kind", "disc"}, {"x", 0}, {"y", 0}, {"length", 0.2}});
  const std::string before = step_to(60);
  tell({{"do", "seek"}, {"tick", 30}});
  EXPECT_EQ(scalar(frame(30), "tick"), 30);
  const std::string again = step_to(60);
  // Wall-clock figures differ; what happened does not.
  for (const char* name : {"x", "y", "yaw", "speed", "command_steer", "minimum_cost", "effective_samples"})
    EXPECT_EQ(scalar(before, name), scalar(again, name)) << name;
}

TEST_F(ViewSession, GoesBackToTheStateOfEveryAction) {
  // A second has 40 ticks: none of these states is that of a copy.
  step_to(50);
  tell({{"do", "ghost"}, {"method", "mppi"}});
  step_to(55);
  tell({{"do", "set"}, {"key", "svg_mppi.samples"}, {"value", "64"}});
  step_to(57);
  tell({{"do", "nudge"}, {"left", 0.05}});
  const std::string before = step_to(70);
  const std::string_view ghost = FrameReader(before).block(Block::ghost_frame);
  ASSERT_FALSE(ghost.empty());
  tell({{"do", "seek"}, {"tick", 60}});
  const std::string again = step_to(70);
  for (const char* name : {"x", "y", "speed", "samples", "minimum_cost"})
    EXPECT_EQ(scalar(before, name), scalar(again, name)) << name;
  EXPECT_EQ(scalar(ghost, "x"), scalar(FrameReader(again).block(Block::ghost_frame), "x"));
  tell({{"do", "seek"}, {"tick", 62}});
  const double shown = scalar(frame(62), "x");
  tell({{"do", "nudge"}, {"left", 0.01}});
  EXPECT_NEAR(scalar(step_to(63), "x"), shown, 0.3) << "from where the car is shown";
  tell({{"do", "seek"}, {"tick", 52}});
  EXPECT_EQ(scalar(step_to(58), "samples"), 128) << "before the option was set";
  tell({{"do", "seek"}, {"tick", 45}});
  EXPECT_TRUE(FrameReader(step_to(46)).block(Block::ghost_frame).empty()) << "before the ghost";
  EXPECT_EQ(last_state_ticks()["ghost"], "");
}

TEST_F(ViewSession, SetsUndoesAndForks) {
  step_to(10);
  tell({{"do", "set"}, {"key", "svg_mppi.samples"}, {"value", "64"}});
  EXPECT_EQ(scalar(step_to(11), "samples"), 64);
  tell({{"do", "undo"}});
  EXPECT_EQ(scalar(step_to(12), "samples"), 128);
  tell({{"do", "fork"}, {"method", "mppi"}});
  const std::string forked = step_to(20);
  EXPECT_EQ(scalar(forked, "method"), 1);
  tell({{"do", "set"}, {"key", "mppi.samples"}, {"value", "0"}});
  EXPECT_NE(next("error")["message"].get<std::string>().find("must be in"), std::string::npos);
  tell({{"do", "set"}, {"key", "mppi.samples"}, {"value", "4000000"}});
  EXPECT_NE(next("error")["message"].get<std::string>().find("in the live view"), std::string::npos);
}

TEST_F(ViewSession, UndoesChangesOfBodies) {
  const auto bodies = [&](int tick) {
    const std::string message = step_to(tick);
    return std::string(FrameReader(message).block(Block::bodies).substr(4 + 24));  // without the driven car
  };
  const std::string before = bodies(10);
  tell({{"do", "add"}, {"kind", "disc"}, {"x", 0}, {"y", 50}, {"length", 0.2}});
  const std::string added = bodies(11);
  EXPECT_GT(added.size(), before.size());
  for (const double x : {0.1, 0.2, 0.3})
    tell({{"do", "move"}, {"body", 3}, {"x", x}, {"y", 50}, {"drag", 5}});
  const std::string moved = bodies(12);
  EXPECT_NE(moved, added);
  tell({{"do", "remove"}, {"body", 1}});
  EXPECT_LT(bodies(13).size(), moved.size());
  tell({{"do", "undo"}});
  EXPECT_EQ(bodies(14), moved) << "with the numbers that they had";
  tell({{"do", "undo"}});
  EXPECT_EQ(bodies(15), added) << "a drag is one change";
  tell({{"do", "undo"}});
  EXPECT_EQ(bodies(16), before);
  tell({{"do", "redo"}});
  EXPECT_EQ(bodies(17), added);
  tell({{"do", "seek"}, {"tick", 9}});
  tell({{"do", "step"}, {"ticks", 1}});
  tell({{"do", "undo"}});
  EXPECT_NE(next("error")["message"].get<std::string>().find("nothing to undo"), std::string::npos)
      << "going back has undone the rest";
}

TEST_F(ViewSession, SendsThePastThatIsAskedFor) {
  step_to(30);
  tell({{"do", "past"}, {"from", 10}, {"to", 12}, {"id", 4}});
  std::string message;
  do message = client_.next_message();
  while (message.rfind("SLV1", 0) != 0 || message[4] != static_cast<char>(Block::past));
  PayloadReader past(FrameReader(message).block(Block::past));
  for (int tick = 10; tick <= 12; ++tick)
    for (const std::string& name : car_scalars()) {
      const double value = past.get<double>();
      if (name == "tick") {
        EXPECT_EQ(value, tick);
      }
    }
  EXPECT_EQ(next("done")["id"], 4);
  tell({{"do", "past"}, {"from", "x"}, {"to", 12}, {"id", 5}});
  EXPECT_EQ(next("error")["id"], 5);
}

TEST_F(ViewSession, ShowsTheStatesOfTrajectoriesWithTwoInputs) {
  tell({{"do", "set"}, {"key", "vehicle.model"}, {"value", "kinematic_acceleration"}});
  const std::string shown = step_to(3);
  const FrameReader reader(shown);
  EXPECT_EQ(PayloadReader(reader.block(Block::plan)).get<std::uint32_t>(), 15u);
  EXPECT_EQ(PayloadReader(reader.block(Block::nominal)).get<std::uint32_t>(), 15u);
  EXPECT_EQ(reader.block(Block::covariance).size(), 14 * sizeof(float)) << "of the steering";
  PayloadReader candidates(reader.block(Block::candidates)), guides(reader.block(Block::guides));
  EXPECT_GT(candidates.get<std::uint16_t>(), 0);
  EXPECT_EQ(candidates.get<std::uint16_t>(), 15);
  EXPECT_GT(guides.get<std::uint16_t>(), 0);
  EXPECT_GT(guides.get<std::uint16_t>(), 0);
  EXPECT_EQ(guides.get<std::uint16_t>(), 15);
}

TEST_F(ViewSession, RejectsUnknownCommandsAndContinues) {
  const char* const bad[] = {"",
                             "{",
                             "[1,2]",
                             "null",
                             "{\"do\":5}",
                             "{\"do\":\"fly\"}",
                             "{\"do\":\"seek\",\"tick\":\"x\"}",
                             "{\"do\":\"add\",\"kind\":\"disc\",\"x\":1e999,\"y\":0}",
                             "{\"do\":\"add\",\"kind\":\"moon\",\"x\":1,\"y\":0}",
                             "{\"do\":\"rate\",\"rate\":-1}",
                             "{\"do\":\"rate\",\"rate\":1e-300}",
                             "\xff\xfe"};
  const auto before = session_.refused();
  for (const char* text : bad) say(text);
  EXPECT_GE(session_.refused() - before, std::size(bad) - 2)
      << "text that is not UTF-8 ends the connection instead";
}

TEST_F(ViewSession, APauseShowsTheNewestTickHoweverFastTheDriveIs) {
  tell({{"do", "rate"}, {"rate", 0}});
  tell({{"do", "play"}});
  for (int turn = 0; turn < 50; ++turn) session_.turn();
  tell({{"do", "pause"}});
  tell({{"do", "no such command"}});
  double shown = -1, newest = -2;
  for (bool ended = false; !ended;) {
    const std::string message = client_.next_message();
    ASSERT_FALSE(message.empty());
    if (message.rfind("SLV1", 0) == 0) {
      if (message[4] == 1) shown = scalar(message, "tick");
      continue;
    }
    const json parsed = json::parse(message);
    if (parsed["type"] == "state") newest = parsed["newest"];
    ended = parsed["type"] == "error";
  }
  EXPECT_GE(newest, 50);
  if (shown < newest) {  // messages overtake frames
    EXPECT_FALSE(frame(static_cast<int>(newest)).empty());
  }
}

/// The figures of a frame that follow from states, obstacles and options.
std::vector<double> facts(const std::string& frame) {
  std::vector<double> all;
  for (const char* name : {"x", "y", "yaw", "speed", "samples", "minimum_cost", "expected_cost",
                           "command_steer", "collided_share"})
    all.push_back(scalar(frame, name));
  return all;
}

class ViewSessionPaused : public ViewSession {
 protected:
  /// The frame that the last command made of a tick.
  std::string answer(int tick) {
    tell({{"do", "past"}, {"from", tick}, {"to", tick}, {"id", 77}});
    next("done");
    return frame(tick);
  }
  /// A disc in front of the car as a frame shows it.
  json disc_ahead(const std::string& frame) const {
    const double yaw = scalar(frame, "yaw");
    return {{"do", "add"},
            {"kind", "disc"},
            {"x", scalar(frame, "x") + 1.5 * std::cos(yaw)},
            {"y", scalar(frame, "y") + 1.5 * std::sin(yaw)},
            {"length", 0.3}};
  }
};

TEST_F(ViewSessionPaused, EveryChangeIsPlannedForAgainFromTheStateThatIsShown) {
  const std::string before = step_to(30);
  tell(disc_ahead(before));
  const std::string added = answer(30);
  EXPECT_EQ(scalar(added, "x"), scalar(before, "x")) << "the car stays";
  EXPECT_EQ(scalar(added, "y"), scalar(before, "y"));
  EXPECT_GT(scalar(added, "collided_share"), scalar(before, "collided_share")) << "the solver saw the disc";
  EXPECT_LT(scalar(added, "clearance"), 1.5);
  tell({{"do", "set"}, {"key", "svg_mppi.samples"}, {"value", "64"}});
  EXPECT_EQ(scalar(answer(30), "samples"), 64);
  tell({{"do", "method"}, {"method", "mppi"}});
  EXPECT_EQ(scalar(answer(30), "method"), 1);
  tell({{"do", "undo"}});
  EXPECT_EQ(scalar(answer(30), "method"), 0);
  tell({{"do", "undo"}});
  EXPECT_EQ(scalar(answer(30), "samples"), 128);
  tell({{"do", "ghost"}, {"method", "svg_mppi"}});
  EXPECT_FALSE(FrameReader(answer(30)).block(Block::ghost_frame).empty());
  EXPECT_EQ(last_state_ticks()["tick"], 30);
}

TEST_F(ViewSessionPaused, WhatIsShownIsWhatIsDriven) {
  const std::string before = step_to(30);
  tell(disc_ahead(before));
  const auto added = facts(answer(30)), driven = facts(step_to(40));
  tell({{"do", "seek"}, {"tick", 30}});
  EXPECT_EQ(facts(frame(30)), added);
  EXPECT_EQ(facts(step_to(40)), driven) << "the stored drive has the change";
  tell({{"do", "seek"}, {"tick", 20}});
  tell(disc_ahead(frame(20)));
  EXPECT_GT(scalar(answer(20), "collided_share"), 0);
  EXPECT_EQ(last_state_ticks()["newest"], 20) << "a change of an earlier tick replaces what followed";
  tell({{"do", "undo"}});
  EXPECT_EQ(facts(step_to(30)), facts(before));
}

TEST_F(ViewSessionPaused, AChangeJustBeforeAPauseIsShown) {
  const std::string before = step_to(30);
  tell({{"do", "rate"}, {"rate", 0.5}});
  tell({{"do", "play"}});
  tell(disc_ahead(before));
  tell({{"do", "pause"}});
  const int newest = last_state_ticks()["newest"];
  tell({{"do", "seek"}, {"tick", newest}});
  EXPECT_EQ(FrameReader(frame(newest)).block(Block::bodies).size(),
            FrameReader(before).block(Block::bodies).size() + 24);
}

TEST_F(ViewSession, OneClientDrivesAndAnotherTakesOver) {
  testing::PageClient other(server_, 2);
  session_.turn();
  EXPECT_EQ(next(other, "role")["drives"], false);
  const auto tell_from_other = [&](const json& command) {
    other.send_message(command.dump());
    server_.wait(std::chrono::seconds(5));
    session_.turn();
  };
  tell_from_other({{"do", "step"}, {"id", 1}});
  EXPECT_NE(next(other, "error")["message"].get<std::string>().find("take over"), std::string::npos);
  tell_from_other({{"do", "past"}, {"from", 0}, {"to", 0}, {"id", 2}});
  EXPECT_EQ(next(other, "done")["id"], 2);
  tell_from_other({{"do", "take_over"}});
  EXPECT_EQ(next(other, "role")["drives"], true);
  tell_from_other({{"do", "step"}, {"id", 3}});
  EXPECT_EQ(next(other, "done")["id"], 3);
  tell({{"do", "step"}, {"id", 4}});
  EXPECT_EQ(next("error")["id"], 4);
}

TEST_F(ViewSession, LoadsOnlyListedCourses) {
  tell({{"do", "scenario"}, {"course", "/etc"}});
  EXPECT_NE(next("error")["message"].get<std::string>().find("is unknown"), std::string::npos);
  tell({{"do", "scenario"}, {"course", "eel"}, {"obstacles", 0}, {"seed", "9"}});
  const json state = last_state_ticks();
  EXPECT_EQ(state["course"], "eel");
  EXPECT_EQ(state["seed"], "9");
}

}  // namespace
}  // namespace slalom::view
