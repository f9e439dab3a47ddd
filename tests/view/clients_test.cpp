// What one client asks for does not delay another: the work of a turn is bounded, whatever waits.
#include "view/session_fixture.hpp"

#include <optional>

namespace slalom::view {
namespace {

SessionOptions with_evaluation() {
  SessionOptions options = session_options();
  options.load_lap = [load = options.load, names = options.scenario](int, int lap) {
    ScenarioNames of_lap = names;
    of_lap.seed = static_cast<std::uint64_t>(lap);
    return LoadedLap{of_lap, load(of_lap)};
  };
  return options;
}

/// A session with the client of the fixture, and one that asks for as much work as it can.
class TwoClients : public ViewSession {
 protected:
  TwoClients() : ViewSession(with_evaluation()) {}

  void SetUp() override {
    ViewSession::SetUp();
    hostile_.emplace(server_.port());
    hostile_->get("/ws", true);
    for (int i = 0; i < 30000 && server_.clients() < 2; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    ASSERT_EQ(server_.clients(), 2);
    session_.turn();
  }

  /// Sends a command and waits until the session could take it.
  void deliver(testing::WebClient& from, const json& command) {
    skipped_.clear();
    const auto before = server_.counters().messages;
    from.send_message(command.dump());
    for (int i = 0; i < 60000 && server_.counters().messages == before; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_GT(server_.counters().messages, before);
  }
  /// One turn, of which the ticks that are driven again are counted.
  void turn() {
    const auto before = session_.redriven();
    session_.turn();
    EXPECT_LE(session_.redriven() - before, static_cast<std::uint64_t>(max_redriven_ticks));
  }
  void turns(int count) {
    for (int i = 0; i < count; ++i) turn();
  }
  /// Turns until nothing waits; how many that took, at most `most`.
  int turns_until_idle(int most) {
    int count = 0;
    for (; count < most && session_.is_busy(); ++count) turn();
    return count;
  }
  /// Ends the connection of the hostile client. Nothing waits for it within a few turns.
  void leave() {
    hostile_.reset();
    for (int i = 0; i < 60000 && server_.clients() > 1; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_EQ(server_.clients(), 1);
    for (int i = 0; i < 5 && session_.is_busy(); ++i) {
      server_.wait(std::chrono::milliseconds(100));
      turn();
    }
    EXPECT_FALSE(session_.is_busy());
  }

  std::optional<testing::WebClient> hostile_;
};

TEST_F(TwoClients, StepsOfOneDoNotDelayTheCommandsOfTheOther) {
  for (int i = 0; i < 60; ++i) deliver(*hostile_, {{"do", "step"}, {"ticks", 400}});
  turn();
  ASSERT_TRUE(session_.is_stepping());
  deliver(client_, {{"do", "pause"}, {"id", 1}});
  turn();
  EXPECT_FALSE(session_.is_stepping()) << "a pause must not wait for the 24,000 steps";
  EXPECT_EQ(next("done")["id"], 1);
}

TEST_F(TwoClients, ReturnsToThePastOfOneDoNotDelayTheOther) {
  step_to(300);
  for (int i = 0; i < 30; ++i) {
    deliver(*hostile_, {{"do", "seek"}, {"tick", 299}});
    deliver(*hostile_, {{"do", "nudge"}, {"left", 0.01}});
  }
  deliver(client_, {{"do", "past"}, {"from", 10}, {"to", 12}, {"id", 1}});
  turn();
  EXPECT_TRUE(session_.is_busy()) << "the past of the hostile client is still being driven";
  EXPECT_EQ(next("done")["id"], 1);
  // What also needs the past comes next, however much the hostile client asks for.
  deliver(client_, {{"do", "add"}, {"kind", "disc"}, {"x", 0}, {"y", 50}, {"length", 0.2}, {"id", 2}});
  for (int i = 0; i < 30; ++i) {
    deliver(*hostile_, {{"do", "seek"}, {"tick", 299}});
    deliver(*hostile_, {{"do", "nudge"}, {"left", 0.01}});
  }
  // Each turn drives at least two ticks, and each of the two clients waits for 300 at most.
  EXPECT_LT(turns_until_idle(400), 400);
  EXPECT_EQ(next("done")["id"], 2);
}

TEST_F(TwoClients, CopiesForGhostsOfOneDoNotDelayTheDriveOfTheOther) {
  step_to(200);
  for (int i = 0; i < 4; ++i) deliver(*hostile_, {{"do", "ghost"}, {"method", "mppi"}});
  turn();
  deliver(client_, {{"do", "step"}, {"ticks", 3}, {"id", 1}});
  turns(4);
  EXPECT_EQ(next("done")["id"], 1);
  EXPECT_FALSE(session_.is_stepping());
  EXPECT_TRUE(session_.is_busy());
  EXPECT_FALSE(frame(203).empty());
  // Four copies of 204 ticks, at two ticks a turn or more.
  EXPECT_LT(turns_until_idle(500), 500);
  EXPECT_EQ(last_state_ticks()["ghost"], "mppi");
}

TEST_F(TwoClients, AGhostCatchesUpWithADriveThatContinues) {
  step_to(60);
  tell({{"do", "rate"}, {"rate", 0}});
  deliver(*hostile_, {{"do", "ghost"}, {"method", "mppi"}, {"id", 7}});
  deliver(client_, {{"do", "play"}});
  turns(70);  // the copy gains a tick a turn or more
  EXPECT_EQ(next(*hostile_, "done")["id"], 7);
  const json state = last_state_ticks();
  EXPECT_EQ(state["ghost"], "mppi");
  EXPECT_GE(state["newest"], 120) << "the drive did not wait for the copy";
}

TEST_F(TwoClients, AClientThatLeavesOrGoesElsewhereCancelsWhatItWaitsFor) {
  step_to(200);
  deliver(*hostile_, {{"do", "seek"}, {"tick", 190}});
  deliver(*hostile_, {{"do", "nudge"}, {"left", 0.01}, {"id", 5}});
  turn();
  ASSERT_TRUE(session_.is_busy());
  deliver(*hostile_, {{"do", "seek"}, {"tick", 100}});
  turn();
  EXPECT_FALSE(session_.is_busy());
  const json error = next(*hostile_, "error");
  EXPECT_EQ(error["id"], 5);
  EXPECT_NE(error["message"].get<std::string>().find("nudge: cancelled, since 'seek' came"),
            std::string::npos);

  deliver(*hostile_, {{"do", "nudge"}, {"left", 0.01}});
  turn();
  ASSERT_TRUE(session_.is_busy());
  leave();
  const json state = last_state_ticks();
  EXPECT_EQ(state["newest"], 200) << "the nudge had no effect";
  EXPECT_EQ(state["edited"], false);
}

TEST_F(TwoClients, LapsOfOneDoNotDelayTheOther) {
  for (int i = 0; i < 5; ++i)
    deliver(*hostile_, {{"do", "lap"}, {"experiment", 0}, {"lap", i}, {"contact", 50}, {"id", i}});
  turn();
  deliver(client_, {{"do", "step"}, {"ticks", 3}, {"id", 9}});
  turns(4);
  EXPECT_EQ(next("done")["id"], 9);
  EXPECT_FALSE(session_.is_stepping());
  EXPECT_TRUE(session_.is_busy()) << "the lap is still being searched";
  EXPECT_FALSE(frame(3).empty()) << "the drive of the others continues meanwhile";
  leave();
  EXPECT_EQ(last_state_ticks()["seed"], "4");
}

TEST_F(TwoClients, OptionsThatTakeTooLongAreRefusedToOneAndDoNotDelayTheOther) {
  for (int i = 0; i < 20; ++i) {
    deliver(*hostile_, {{"do", "set"}, {"key", "samples"}, {"value", "4194304"}});
    deliver(*hostile_, {{"do", "fork"}, {"method", "mppi"}, {"set", {"samples=4194304"}}});
  }
  deliver(client_, {{"do", "set"}, {"key", "samples"}, {"value", "20000"}, {"id", 1}});
  deliver(client_, {{"do", "step"}, {"ticks", 2}, {"id", 2}});
  turns(4);
  EXPECT_EQ(next("done")["id"], 1);
  EXPECT_EQ(next("done")["id"], 2);
  EXPECT_EQ(scalar(frame(2), "samples"), 20000);
  turns_until_idle(100);
  for (int i = 0; i < 40; ++i)
    EXPECT_NE(next(*hostile_, "error")["message"].get<std::string>().find("million rollout steps"),
              std::string::npos);
}

TEST_F(TwoClients, RatesThatAreOutOfRangeAreRefusedToOneAndDoNotHurryTheOther) {
  deliver(client_, {{"do", "play"}, {"id", 1}});
  for (int i = 0; i < 20; ++i) deliver(*hostile_, {{"do", "rate"}, {"rate", i % 2 == 0 ? 1e-300 : 1e9}});
  turn();
  EXPECT_EQ(next("done")["id"], 1);
  for (int i = 0; i < 20; ++i)
    EXPECT_NE(next(*hostile_, "error")["message"].get<std::string>().find("rate: must be 0"),
              std::string::npos);
  EXPECT_EQ(last_state_ticks()["rate"], 1);
}

}  // namespace
}  // namespace slalom::view
