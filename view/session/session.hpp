#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "slalom/evaluation/lap.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "src/evaluation/json.hpp"
#include "view/protocol/frame.hpp"
#include "view/protocol/messages.hpp"
#include "view/server/server.hpp"
#include "view/session/redrive.hpp"
#include "view/session/scenario.hpp"
#include "view/session/simulation.hpp"
#include "view/session/slow_motion.hpp"
#include "view/session/undo.hpp"

namespace slalom::view {

struct SessionOptions {
  ScenarioNames scenario;
  std::function<LoadedScenario(const ScenarioNames&)> load;  ///< throws errors for the user
  Choices choices;
  std::string further_arguments;  ///< of the command line that drives the same lap, begins with a space
  double history = 60;            ///< s of steps that are stored and can be shown again
  bool wait_for_client = true;    ///< the drive begins when the first page is opened
  /// An evaluation to show: its message to the page (JSON), and how one of its laps is loaded.
  std::string evaluation{};
  std::function<LoadedLap(int experiment, int lap)> load_lap{};
  std::string against{};      ///< method of a ghost from the start; empty for none
  bool introduction = false;  ///< in slow motion until the first obstacle has been passed; the page shows the
                              ///< ghost beside the car
  bool record_times = false;  ///< recordings hold figures of the wall clock too
  std::string program = "slalom";  ///< who writes recordings
};

/// Drives, sends frames to the clients of a server, and executes their commands. Everything happens in the
/// thread that calls `run`; the server never waits for it nor it for the server.
class Session {
 public:
  /// Throws what `load` throws.
  Session(SessionOptions options, Server& server);
  ~Session();

  /// Until `stop` is set.
  void run(const std::atomic<bool>& stop);

  /// Obeys what has come, drives again a few ticks for a command that waits for them, and makes one tick if
  /// it is due; for tests.
  void turn();

  std::uint64_t refused() const noexcept { return refused_; }  ///< messages that were not valid commands
  bool is_stepping() const noexcept {
    return steps_left_ > 0;
  }  ///< ticks of a command "step" are still to come
  /// Whether commands wait for steps, or for ticks that are driven again.
  bool is_busy() const noexcept { return is_stepping() || !redrives_.empty() || !deferred_.empty(); }
  /// Ticks that were driven again since the start; a turn adds `max_redriven_ticks` at most.
  std::uint64_t redriven() const noexcept { return redriven_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Step {
    int tick;
    std::string without_bodies;
    std::string ghost;  ///< its control step, without its bodies; empty if there is none
    std::shared_ptr<const std::string> frame;
  };
  static std::size_t bytes_of(const Step& step) {
    return 2 * (step.without_bodies.size() + step.ghost.size());
  }

  // Driving.
  void load(const ScenarioNames& names);
  void install(LoadedScenario loaded, const ScenarioNames& names);
  void restart();
  void begin_drive(Simulation simulation, std::optional<Simulation> ghost);
  evaluation::LapSetup make_setup(const vehicle::Configuration& configuration,
                                  const std::string& method) const;
  void tick();
  StepFacts facts_of(const evaluation::LapSetup& setup) const;
  static std::shared_ptr<const std::string> frame_of(const Step& step, const std::string& bodies,
                                                     const std::string& ghost_bodies);
  void slow_down();
  void end_introduction(const std::string& command);
  void note_laps();
  void note_laps_of(const Simulation& simulation, const std::string& method, bool ghost);
  void keep(Step step);
  void go_to_viewed();
  void forget_after(int tick);
  void show(int tick);
  void show_edit();
  Clock::duration until_due() const;

  // Obeying.
  void handle_all();
  bool must_wait(const Received& received) const;
  void defer(Received received);
  void forget(std::uint64_t client);
  void cancel_replaced(const Received& newer);
  void handle(const Received& received);
  Redrive redrive_for(const Received& received, const std::string& what, const Json& command) const;
  void drive_again();
  void execute_prepared();
  bool attempt(std::uint64_t client, const Json& command, const std::function<void()>& action);
  bool execute(std::uint64_t client, const Json& command);
  void obey(std::uint64_t client, const Json& command);
  void edit(const Edit& edit);
  void undo(bool again);
  void change(const vehicle::Configuration& configuration, const std::string& method, bool remember);
  void start_ghost(const std::string& method, const vehicle::Configuration& configuration);
  Simulation make_ghost(const std::string& method, const vehicle::Configuration& configuration);
  void set_ghost(Simulation ghost, const std::string& method, const std::string& label);
  void end_ghost();
  void fork(const Json& command);
  void handle_lap(const Json& command);
  LoadedLap load_lap(const Json& command);
  void search_contact(Redrive& redrive, const Json& command);
  void handle_step(std::uint64_t client, const Json& command);
  void pause(const Json& command);
  void publish_newest();
  bool handle_transport(const std::string& what, const Json& command);
  bool handle_edit(const std::string& what, const Json& command);
  bool handle_options(const std::string& what, const Json& command);
  void handle_scenario(const Json& command);
  void save(std::uint64_t client, const std::string& what);

  // Telling.
  void greet(std::uint64_t client);
  void refuse(std::uint64_t client, const std::string& why, const Json& id = {});
  void tell_done(std::uint64_t client, const Json& id);
  void tell_past(std::uint64_t client, int from, int to);
  void note(const std::string& what);
  void tell_state();
  void tell_options();
  std::string hello() const;
  std::string state() const;
  OptionsFacts options_facts() const;
  std::string options() const;
  std::string command_line() const;

  SessionOptions options_;
  Server& server_;
  std::string number_;  ///< random; a server that is started anew has another
  ScenarioNames names_;
  LoadedScenario scenario_;
  vehicle::Configuration configuration_;
  UndoHistory undo_;
  std::optional<Simulation> simulation_, ghost_;
  std::string ghost_method_, ghost_label_;
  FrameEncoder encoder_;
  std::deque<Step> history_;
  std::size_t history_bytes_ = 0;
  std::vector<LapNote> laps_;
  std::shared_ptr<const std::string> scene_;
  int viewed_ = -1;                    ///< tick that is shown while it is not the newest
  int stop_at_ = -1;                   ///< tick at which to pause
  int steps_left_ = 0;                 ///< ticks of a command "step" that are still to come
  std::uint64_t stepping_client_ = 0;  ///< who asked for them; its further commands wait for them
  std::vector<Received> deferred_;     ///< commands that wait for others of their client, by age
  std::vector<std::uint64_t> served_;  ///< clients that had a costly command in this turn
  std::deque<Redrive> redrives_;       ///< commands that wait for ticks driven again, at most one of a client
  std::optional<Redrive> prepared_;    ///< the one that is executed
  std::uint64_t redriven_ = 0;
  std::array<int, 4> contact_{-1, -1, -1, -1};
  bool waiting_ = true, paused_ = false, real_time_ = false, state_changed_ = true;
  bool introduces_ = false;  ///< the scenario of the introduction is driven, and nobody has changed it
  SlowMotion slow_motion_;
  double rate_ = 1;  ///< of simulated to real time; 0: as fast as it goes
  int generation_ = 0;
  Clock::time_point due_ = Clock::now(), last_state_ = Clock::now(), last_frame_ = Clock::now();
  bool is_newest_sent_ = true;  ///< false where the newest tick came too early for a frame
  std::uint64_t refused_ = 0;
  std::atomic<bool> saving_{false};
  std::jthread saver_;  ///< the last member: it ends before what it uses
};

}  // namespace slalom::view
