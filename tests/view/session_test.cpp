// A session of a car: the drive of the command line, going back exactly, edits, and a ghost.

#include "view/car/car_subject.hpp"
#include "view/paused_session.hpp"
#include "view/recording/drive_files.hpp"

namespace slalom::view {
namespace {

vehicle::Configuration small() {
  vehicle::Configuration configuration;
  for (const char* method : {"svg_mppi", "mppi"})
    for (const auto& [key, value] : {std::pair{"samples", "128"},
                                     {"horizon", "14"},
                                     {"variance", "0.05"},
                                     {"input_min", "-0.4"},
                                     {"input_max", "0.4"},
                                     {"temperature", "3"}})
      vehicle::set_option(configuration, key, value, method);
  vehicle::set_option(configuration, "svg_mppi.batches", "1");
  return configuration;
}

std::shared_ptr<const evaluation::Environment> environment_of(const std::string& course) {
  return evaluation::load_environment(SLALOM_COURSES "/" + course, evaluation::Protocol::true_physics, {});
}

SessionOptions session_options() {
  SessionOptions options;
  options.scenario = {.course = "stag", .method = "svg_mppi", .config = "default", .seed = 4, .obstacles = 2};
  options.load = [](const ScenarioNames& names) {
    return car_subject(
        {environment_of(names.course), {small(), names.method}, {.obstacles = names.obstacles}}, names.seed);
  };
  add_files(options, {});
  options.choices.courses = {"stag", "eel"};
  options.choices.methods = {"svg_mppi", "mppi"};
  options.choices.configurations = {"default"};
  return options;
}

class ViewSession : public ::testing::Test, protected PausedSession {
 protected:
  explicit ViewSession(SessionOptions options = session_options())
      : PausedSession(options.load(options.scenario), options) {}

  std::string error() { return last("error")["message"]; }
  /// A disc in front of the car as a frame shows it.
  json disc_ahead(const std::string& frame) {
    const double yaw = scalar(frame, "yaw");
    return {{"do", "add"},
            {"kind", "disc"},
            {"x", scalar(frame, "x") + 1.5 * std::cos(yaw)},
            {"y", scalar(frame, "y") + 1.5 * std::sin(yaw)},
            {"length", 0.3}};
  }
  /// The figures of a frame that follow from states, obstacles and options.
  std::vector<double> facts(const std::string& frame) {
    std::vector<double> all;
    for (const char* name : {"x", "y", "yaw", "speed", "samples", "minimum_cost", "expected_cost",
                             "command_steer", "collided_share"})
      all.push_back(scalar(frame, name));
    return all;
  }
};

TEST_F(ViewSession, FirstMessagesHoldWhatThePageNeeds) {
  const json hello = last("hello");
  EXPECT_EQ(hello["protocol"], 2);
  EXPECT_EQ(hello["terms"].size(), 3u);
  EXPECT_GT(hello["body"]["front"], 0) << "a car has wheels";
  EXPECT_EQ(hello["scalars"].size(), car_scalars().size());
  EXPECT_EQ(hello["courses"], (json{"stag", "eel"}));
  const json section = last("options")["sections"][0];
  ASSERT_EQ(section["name"], "svg_mppi");
  const auto samples =
      std::ranges::find(section["options"], "samples", [](const json& o) { return o["name"]; });
  ASSERT_NE(samples, section["options"].end());
  const json wanted{{"value", "128"}, {"type", "integer"}, {"min", 1}, {"symbol", "K"}};
  for (const auto& [key, value] : wanted.items()) EXPECT_EQ((*samples)[key], value) << key;
}

TEST_F(ViewSession, TellsTheSymptomOfTheSolver) {
  const json symptoms = last("hello")["symptoms"];
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
  EXPECT_EQ(last("state")["ghost"], "");
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
  const std::vector<std::string> bad{"",
                                     "{",
                                     "[1,2]",
                                     "null",
                                     R"({"do":5})",
                                     R"({"do":"fly"})",
                                     R"({"do":"seek","tick":"x"})",
                                     R"({"do":"past","from":"x","to":12})",
                                     R"({"do":"add","kind":"disc","x":1e999,"y":0})",
                                     R"({"do":"add","kind":"moon","x":1,"y":0})",
                                     R"({"do":"rate","rate":-1})",
                                     R"({"do":"rate","rate":1e-300})"};
  say(bad);
  EXPECT_EQ(session_.refused(), bad.size());
}

TEST_F(ViewSession, APauseShowsTheNewestTickHoweverFastTheDriveIs) {
  tell({{"do", "rate"}, {"rate", 0}});
  tell({{"do", "play"}});
  for (int turn = 0; turn < 50; ++turn) session_.turn();
  const int newest = last("state")["newest"];
  EXPECT_GE(newest, 50);
  if (scalar(shown_, "tick") < newest) next_binary(Block::scalars);  // messages overtake frames
  EXPECT_EQ(scalar(shown_, "tick"), newest);
}

TEST_F(ViewSession, EveryChangeIsPlannedForAgainFromTheStateThatIsShown) {
  const std::string before = step_to(30);
  tell(disc_ahead(before));
  const std::string added = frame(30);
  EXPECT_EQ(scalar(added, "x"), scalar(before, "x")) << "the car stays";
  EXPECT_EQ(scalar(added, "y"), scalar(before, "y"));
  EXPECT_GT(scalar(added, "collided_share"), scalar(before, "collided_share")) << "the solver saw the disc";
  EXPECT_LT(scalar(added, "clearance"), 1.5);
  tell({{"do", "set"}, {"key", "svg_mppi.samples"}, {"value", "64"}});
  EXPECT_EQ(scalar(frame(30), "samples"), 64);
  tell({{"do", "method"}, {"method", "mppi"}});
  EXPECT_EQ(scalar(frame(30), "method"), 1);
  tell({{"do", "undo"}});
  EXPECT_EQ(scalar(frame(30), "method"), 0);
  tell({{"do", "undo"}});
  EXPECT_EQ(scalar(frame(30), "samples"), 128);
  tell({{"do", "ghost"}, {"method", "svg_mppi"}});
  EXPECT_FALSE(FrameReader(frame(30)).block(Block::ghost_frame).empty());
  EXPECT_EQ(last("state")["tick"], 30);
}

TEST_F(ViewSession, WhatIsShownIsWhatIsDriven) {
  const std::string before = step_to(30);
  tell(disc_ahead(before));
  const auto added = facts(frame(30)), driven = facts(step_to(40));
  tell({{"do", "seek"}, {"tick", 30}});
  EXPECT_EQ(facts(frame(30)), added);
  EXPECT_EQ(facts(step_to(40)), driven) << "the stored drive has the change";
  tell({{"do", "seek"}, {"tick", 20}});
  tell(disc_ahead(frame(20)));
  EXPECT_GT(scalar(frame(20), "collided_share"), 0);
  EXPECT_EQ(last("state")["newest"], 20) << "a change of an earlier tick replaces what followed";
  tell({{"do", "undo"}});
  EXPECT_EQ(facts(step_to(30)), facts(before));
}

TEST_F(ViewSession, OneClientDrivesAndAnotherTakesOver) {
  testing::PageClient other(server_, 2);
  session_.turn();
  const auto next = [&](const char* type) {
    json message = json::object();
    for (std::string text; message.value("type", "") != type;) {
      do text = other.next_message();
      while (text.starts_with("SLV1"));
      message = json::parse(text);
    }
    return message;
  };
  EXPECT_EQ(next("role")["drives"], false);
  const auto tell_from_other = [&](const json& command) {
    other.send_message(command.dump());
    server_.wait(std::chrono::seconds(5));
    session_.turn();
  };
  tell_from_other({{"do", "step"}, {"id", 1}});
  EXPECT_NE(next("error")["message"].get<std::string>().find("take over"), std::string::npos);
  tell_from_other({{"do", "past"}, {"from", 0}, {"to", 0}, {"id", 2}});
  EXPECT_EQ(next("done")["id"], 2);
  tell_from_other({{"do", "take_over"}});
  EXPECT_EQ(next("role")["drives"], true);
  tell_from_other({{"do", "step"}, {"id", 3}});
  EXPECT_EQ(next("done")["id"], 3);
  tell({{"do", "step"}, {"id", 4}});
  figure("tick", 0);
  EXPECT_EQ(last_["error"]["id"], 4);
}

TEST_F(ViewSession, LoadsOnlyListedCourses) {
  tell({{"do", "scenario"}, {"course", "/etc"}});
  EXPECT_NE(error().find("is unknown"), std::string::npos);
  tell({{"do", "scenario"}, {"course", "eel"}, {"obstacles", 0}, {"seed", "9"}});
  const json state = last("state");
  EXPECT_EQ(state["course"], "eel");
  EXPECT_EQ(state["seed"], "9");
}

/// The frame of the ghost within a frame.
std::string_view ghost_of(const std::string& frame) {
  return FrameReader(frame).block(Block::ghost_frame);
}

TEST_F(ViewSession, FramesHoldWhatBothControllersConsider) {
  tell({{"do", "ghost"}, {"method", "mppi"}});
  const std::string both = step_to(3);
  const std::string_view ghost = ghost_of(both);
  ASSERT_FALSE(ghost.empty());
  EXPECT_EQ(scalar(both, "method"), 0);
  EXPECT_EQ(scalar(ghost, "method"), 1);
  EXPECT_EQ(scalar(ghost, "tick"), 3) << "of the same control step";
  const FrameReader reader(ghost);
  for (const Block block : {Block::scan, Block::candidates, Block::nominal, Block::plan, Block::bodies})
    EXPECT_FALSE(reader.block(block).empty()) << static_cast<int>(block);
  // The car, then the parked cars; both worlds have the same.
  EXPECT_EQ(PayloadReader(reader.block(Block::bodies)).get<std::uint32_t>(), 3u);
  EXPECT_EQ(reader.block(Block::bodies).substr(4 + 24),
            FrameReader(both).block(Block::bodies).substr(4 + 24));
  tell({{"do", "ghost"}, {"method", ""}});
  EXPECT_TRUE(ghost_of(step_to(4)).empty());
}

}  // namespace
}  // namespace slalom::view
