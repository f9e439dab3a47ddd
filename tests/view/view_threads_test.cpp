// The live view when the system cannot start a thread: that of the server, one that writes a file, those of a
// solver.
#include <fcntl.h>

#include <memory>
#include <stdexcept>

#include "slalom/evaluation/lap.hpp"
#include "support/thread_starts.hpp"
#include "view/protocol/frame_writer.hpp"
#include "view/session_fixture.hpp"

namespace slalom::view {
namespace {

using testing::FewThreads;

/// Every solver of the session has three threads, so it must start two.
SessionOptions with_three_threads() {
  SessionOptions options = session_options();
  options.load = [load = options.load](const ScenarioNames& names) {
    LoadedScenario loaded = load(names);
    loaded.lap.threads = 3;
    return loaded;
  };
  options.load_lap = [load = options.load, names = options.scenario](int, int lap) {
    ScenarioNames of_lap = names;
    of_lap.seed = static_cast<std::uint64_t>(lap);
    return LoadedLap{of_lap, load(of_lap)};
  };
  return options;
}

int next_descriptor() {
  const int next = open("/dev/null", O_RDONLY | O_CLOEXEC);
  close(next);
  return next;
}

class ViewThreads : public ViewSession {
 protected:
  ViewThreads() : ViewSession(with_three_threads()) {}

  /// The answer to a command.
  json answer(json command) {
    command["id"] = ++last_id_;
    tell(command);
    for (;;) {
      const std::string message = client_.next_message();
      if (message.empty()) return nullptr;
      if (message.rfind("SLV1", 0) == 0) continue;
      json parsed = json::parse(message);
      if (parsed.value("id", 0) == last_id_) return parsed;
    }
  }
  /// The state of the session, which this pauses.
  json state() {
    json all = last_state_ticks();
    all.erase("refused");
    return all;
  }
  /// The command is refused, and nothing has changed, when only so many threads can be started.
  void refuses(const json& command, int possible) {
    const json before = state();
    json said;
    {
      const FewThreads few(possible);
      said = answer(command);
    }
    ASSERT_EQ(said["type"], "error") << command << ", " << possible;
    EXPECT_NE(said["message"].get<std::string>().find("cannot start"), std::string::npos) << said;
    EXPECT_EQ(state(), before) << command << ", " << possible;
  }

 private:
  int last_id_ = 0;
};

TEST(ViewThreadsServer, AServerWithoutItsThreadThrowsAndLeavesNothingOpen) {
  const std::uint16_t port = Server({}, {}).port();
  const int before = next_descriptor();
  std::string message;
  try {
    const FewThreads none(0);
    Server server({.port = port}, {});
  } catch (const std::runtime_error& error) {
    message = error.what();
  }
  EXPECT_NE(message.find("cannot start the thread of the server"), std::string::npos) << message;
  EXPECT_EQ(next_descriptor(), before);
  Server server({.port = port}, {{"/", {"text/html", "", "<p>here</p>"}}});
  EXPECT_NE(testing::WebClient(port).get("/").find(" 200 "), std::string::npos);
}

TEST(ViewThreadsServer, ASessionWithoutTheThreadsOfItsSolverIsNotMade) {
  Server server({}, {});
  for (int possible = 0; possible < 4; ++possible) {
    const FewThreads few(possible);
    EXPECT_THROW(std::make_unique<Session>(with_three_threads(), server), std::runtime_error) << possible;
  }
  EXPECT_NO_THROW(std::make_unique<Session>(with_three_threads(), server));
}

TEST_F(ViewThreads, AFileThatCannotBeSavedDoesNotBlockTheNext) {
  step_to(5);
  const json save = {{"do", "save"}, {"what", "recording"}};
  refuses(save, 0);
  tell(save);
  std::string message;
  do message = client_.next_message();
  while (!message.empty() && (message.rfind("SLV1", 0) != 0 || message[4] != static_cast<char>(Block::file)));
  EXPECT_NE(message.find(".mcap"), std::string::npos);
  EXPECT_EQ(scalar(step_to(8), "tick"), 8);
}

TEST_F(ViewThreads, ACommandWithoutTheThreadsOfItsSolverChangesNothing) {
  step_to(9);
  ASSERT_EQ(answer({{"do", "set"}, {"key", "svg_mppi.samples"}, {"value", "64"}})["type"], "done");
  const json commands[] = {{{"do", "undo"}},
                           {{"do", "set"}, {"key", "svg_mppi.samples"}, {"value", "32"}},
                           {{"do", "preset"}, {"set", json::array({"svg_mppi.temperature=5"})}},
                           {{"do", "reset_options"}},
                           {{"do", "method"}, {"method", "mppi"}},
                           {{"do", "fork"}, {"method", "svg_mppi"}},
                           {{"do", "ghost"}, {"method", "svg_mppi"}},
                           {{"do", "restart"}},
                           {{"do", "scenario"}, {"course", "eel"}, {"obstacles", 0}},
                           {{"do", "lap"}, {"experiment", 0}, {"lap", 4}}};
  // Each makes two solvers or more: one to check the options, and that which drives.
  for (const json& command : commands)
    for (int possible = 0; possible < 4; ++possible) refuses(command, possible);
  // One that continues from an earlier tick makes a solver to drive again up to it.
  tell({{"do", "seek"}, {"tick", 5}});
  for (int possible = 0; possible < 2; ++possible) refuses({{"do", "step"}}, possible);
  tell({{"do", "seek"}, {"tick", 9}});

  const std::string shown = step_to(30);
  EXPECT_EQ(scalar(shown, "samples"), 64);
  const ScenarioNames names = session_options().scenario;
  const LoadedScenario loaded = session_options().load(names);
  vehicle::Configuration changed = loaded.configuration;
  vehicle::set_option(changed, "svg_mppi.samples", "64", "svg_mppi");
  evaluation::LapDrive loop({loaded.environment, {loaded.configuration, names.method}, loaded.lap},
                            names.seed);
  double x = 0;
  while (loop.steps() <= 30) {
    if (loop.steps() == 10) loop.change_driver({changed, names.method});
    loop.step([&](const evaluation::ControlStep& step) { x = step.seen.pose.x; });
  }
  EXPECT_EQ(scalar(shown, "x"), x) << "the drive is that without the commands";

  ASSERT_EQ(answer({{"do", "set"}, {"key", "svg_mppi.temperature"}, {"value", "4"}})["type"], "done");
  EXPECT_EQ(scalar(step_to(31), "samples"), 64) << "no refused option has been kept";
  for (const json& command : commands) EXPECT_EQ(answer(command)["type"], "done") << command;
}

}  // namespace
}  // namespace slalom::view
