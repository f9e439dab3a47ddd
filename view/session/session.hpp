#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "view/protocol/frame.hpp"
#include "view/protocol/messages.hpp"
#include "view/server/audience.hpp"
#include "view/session/drives.hpp"
#include "view/session/pace.hpp"

namespace slalom::view {

using Timeline = TimelineOf<Drives>;

/// A scenario, loaded.
struct LoadedScenario {
  std::shared_ptr<const evaluation::Environment> environment;
  vehicle::Configuration configuration;
  evaluation::LapSettings lap;
};

/// A lap of an evaluation, loaded.
struct LoadedLap {
  ScenarioNames names;
  LoadedScenario scenario;
};

struct SessionOptions {
  ScenarioNames scenario;
  std::function<LoadedScenario(const ScenarioNames&)> load;  ///< throws errors for the user
  Choices choices;
  std::string further_arguments;  ///< arguments of the equivalent command line; begins with a space
  std::string evaluation{};       ///< message (JSON) of an evaluation to show
  std::function<LoadedLap(int experiment, int lap)> load_lap{};  ///< loads a lap of the evaluation
  std::string against{};                                         ///< method of a ghost from the start, if any
  bool introduction = false;       ///< in slow motion until the first obstacle has been passed
  bool record_all = false;         ///< recordings and replays contain everything
  bool record_times = false;       ///< recordings contain wall-clock times
  std::string program = "slalom";  ///< name of the program in recordings
};

/// Drives, sends frames to the clients of a server, and executes the commands of the client that drives; the
/// others watch, and can take over. Everything happens in the thread that calls `run`, which never waits for
/// a client.
class Session {
 public:
  /// Throws what `load` throws.
  Session(SessionOptions options, Server& server);

  /// Runs until `stop` is set.
  void run(const std::atomic<bool>& stop);
  /// Executes the commands that have come, and drives one tick if it is due; for tests.
  void turn();

  /// Number of messages that were not valid commands.
  std::uint64_t refused() const noexcept { return audience_.refused(); }
  /// Whether ticks of a command "step" are left.
  bool is_busy() const noexcept { return steps_left_ > 0; }

 private:
  using Clock = Pace::Clock;
  static constexpr int scan_lead = 1;  ///< ticks before the one that is shown, whose end made its scan
  using Json = nlohmann::ordered_json;
  /// The options or the bodies that a change has replaced after some ticks.
  struct Change {
    int ticks;
    std::variant<vehicle::Configuration, std::vector<Body>> before;
  };

  // Driving.
  void install(LoadedScenario loaded, const ScenarioNames& names);
  void restart();
  void begin(Drives drives);
  void tick(bool is_shown = true);
  void show_step(int tick);
  void publish_newest();
  void slow_down();
  void note_laps(const evaluation::LapDrive& drive, const std::string& method, bool is_ghost);
  StepFacts facts_of(const evaluation::LapDrive& drive) const;
  Clock::duration until_due() const;

  // Changing the drive, from the tick that is shown on.
  bool is_held() const;
  const Drives& present(int lead = 0);
  void continue_from_shown();
  void forget_after(int tick, int ticks);
  void perform(const std::vector<Action>& actions, int lead = 0);
  void remember(decltype(Change::before) before, int drag = 0);
  void change_driver(const vehicle::Configuration& configuration, const std::string& method);
  void undo(bool again);
  void fork(const Json& command);
  void set_ghost(const std::string& method);
  void show_lap(const Json& command);

  // Commands.
  void obey(std::uint64_t client, const std::string& what, const Json& command);
  bool obey_transport(const std::string& what, const Json& command);
  bool obey_options(const std::string& what, const Json& command);
  void save(std::uint64_t client, const std::string& what);

  // Messages.
  void join(std::uint64_t client);
  void tell_past(std::uint64_t client, int from, int to);
  std::string hello() const;
  std::string state() const;
  OptionsFacts options_facts() const;

  const evaluation::LapSetup& setup() const { return drives_->car.setup(); }
  const evaluation::Driver& driver() const { return setup().driver; }
  double control_period() const { return setup().control_period(); }
  int shown_tick() const { return viewed_ >= 0 ? viewed_ : timeline_.newest(); }

  SessionOptions options_;
  Server& server_;
  Audience audience_;

  vehicle::Configuration loaded_;             ///< the configuration of the scenario, without changes
  std::shared_ptr<const std::string> scene_;  ///< message with the course
  std::optional<Drives> drives_;
  Timeline timeline_;
  std::optional<Drives> held_;       ///< while paused: what a change last applied to, with the change
  int acted_ = 0;                    ///< ticks before the last change
  std::vector<Change> undo_, redo_;  ///< changes to undo and to do again, newest last
  int drag_ = 0;                     ///< the drag of the last change
  /// The drive as pages are told of it. `state` fills in what follows from drives and timeline.
  DriveState state_;

  FrameEncoder encoder_;
  Delays last_updates_;         ///< s of wall clock
  std::size_t copy_bytes_ = 0;  ///< about the size of a copy of the drives

  bool waiting_ = true;     ///< for the first page to be opened
  int viewed_ = -1;         ///< tick that is shown while it is not the newest
  int stop_at_ = -1;        ///< tick at which to pause
  int steps_left_ = 0;      ///< ticks of a command "step" that are still to come
  int passing_ticks_ = -1;  ///< ticks of the introduction since the cars came to the obstacle; -1 before
  Pace pace_;
  Clock::time_point last_state_ = Clock::now(), last_frame_ = last_state_;
  bool is_newest_sent_ = true;  ///< false if the newest tick came too early for a frame
  bool is_state_changed_ = true, are_options_changed_ = false;
  std::future<void> saving_;  ///< the last member: its thread ends before what it uses
};

}  // namespace slalom::view
