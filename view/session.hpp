#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "frame.hpp"
#include "server.hpp"
#include "simulation.hpp"
#include "slalom/evaluation/lap_runner.hpp"
#include "slalom/vehicle/configuration.hpp"

namespace slalom::view {

/// What is driven, in the words of the command line.
struct ScenarioNames {
  std::string course = "stag";
  std::string method = "svg_mppi";
  std::string config = "default";
  std::uint64_t seed = 0;
  int obstacles = 0;
  bool operator==(const ScenarioNames&) const = default;
};

/// The same, loaded.
struct LoadedScenario {
  std::shared_ptr<const evaluation::Arena> arena;
  vehicle::Configuration configuration;
  evaluation::LapSettings lap;
};

struct SessionOptions {
  ScenarioNames scenario;
  std::function<LoadedScenario(const ScenarioNames&)> load;   ///< throws what is to be told to the user
  std::vector<std::string> courses, methods, configurations;  ///< to choose from
  std::string further_arguments;  ///< of the command line that drives the same lap, begins with a space
  double history = 60;            ///< s that can be gone back
  bool wait_for_client = true;    ///< the drive begins when the first page is opened
};

/// Drives, tells the clients of a server about it, and obeys them. Everything happens in the thread that
/// calls `run`; the server never waits for it nor it for the server.
class Session {
 public:
  /// Throws what `load` throws.
  Session(SessionOptions options, Server& server);
  ~Session();

  /// Until `stop` is set.
  void run(const std::atomic<bool>& stop);

  /// Obeys what has come and makes one tick if it is due; for tests.
  void turn();

  std::uint64_t refused() const noexcept { return refused_; }  ///< messages that were no commands

 private:
  using Clock = std::chrono::steady_clock;
  struct Lap {
    int tick, lap;
    double time;
    int contacts;
    std::string method;
  };
  struct Step {
    int tick;
    std::string without_bodies;
    std::shared_ptr<const std::string> frame;
  };

  // Driving.
  void load(const ScenarioNames& names);
  void restart();
  std::shared_ptr<const evaluation::LapRunner> make_runner(const vehicle::Configuration& configuration,
                                                           const std::string& method) const;
  void tick();
  void note_laps();
  void keep(Step step);
  void go_to_viewed();
  void forget_after(int tick);
  void show(int tick);
  void show_edit();
  Clock::duration until_due() const;

  // Obeying.
  void obey(const Received& received);
  void obey(const nlohmann::json& command);
  void edit(const Edit& edit);
  void change(const vehicle::Configuration& configuration, const std::string& method, bool remember);
  void start_ghost(const std::string& method);
  bool obey_transport(const std::string& what, const nlohmann::json& command);
  bool obey_edit(const std::string& what, const nlohmann::json& command);
  bool obey_options(const std::string& what, const nlohmann::json& command);
  void obey_scenario(const nlohmann::json& command);

  // Telling.
  void greet(std::uint64_t client);
  void refuse(std::uint64_t client, const std::string& why);
  void tell_state();
  void tell_options();
  std::string hello_message() const;
  std::string state_message() const;
  std::string options_message() const;
  std::vector<std::string> changed_options() const;
  std::string command_line() const;
  std::string changed_yaml() const;

  SessionOptions options_;
  Server& server_;
  ScenarioNames names_;
  LoadedScenario scenario_;
  vehicle::Configuration configuration_;
  std::vector<vehicle::Configuration> undo_, redo_;
  std::optional<Simulation> simulation_, ghost_;
  std::string ghost_method_;
  std::vector<maps::Pose> ghost_plan_;
  FrameEncoder encoder_;
  std::deque<Step> history_;
  std::size_t history_bytes_ = 0;
  std::vector<Lap> laps_;
  std::shared_ptr<const std::string> scene_;
  int viewed_ = -1;  ///< tick that is shown while it is not the newest
  bool waiting_ = true, paused_ = false, real_time_ = false, state_changed_ = true;
  double rate_ = 1;  ///< of simulated to real time; 0: as fast as it goes
  int generation_ = 0;
  Clock::time_point due_ = Clock::now(), last_state_ = Clock::now(), last_frame_ = Clock::now();
  std::uint64_t refused_ = 0;
};

}  // namespace slalom::view
