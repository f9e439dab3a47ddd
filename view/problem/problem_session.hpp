#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "slalom/core/polymorphic.hpp"
#include "slalom/view/subject.hpp"
#include "view/problem/problem_frame.hpp"
#include "view/server/audience.hpp"
#include "view/session/pace.hpp"
#include "view/session/timeline.hpp"

namespace slalom::view {

/// A user's own problem and where its state is. A copy continues bit for bit like the original.
struct Run {
  Polymorphic<Subject> subject;
  std::vector<double> state;
  double period = 0;   ///< s of a control step
  int steps = 0;       ///< control steps until now
  double elapsed = 0;  ///< s since the last solve

  int ticks() const noexcept { return steps; }
  /// Solves from the present state.
  const SolveResult& decide();
  /// Applies the first input of the plan.
  void advance();
  void tick(const Delays&) {
    decide();
    advance();
  }
};

/// Drives a user's own problem for the pages that are open, and executes their commands. Everything happens
/// in the thread that calls `turn`.
class ProblemSession {
 public:
  /// Throws std::invalid_argument if the subject is not valid.
  ProblemSession(std::unique_ptr<Subject> subject, Server& server);
  /// Executes the commands that have come, and drives one step if it is due; waits for one, for `at_most` at
  /// most.
  void turn(std::chrono::nanoseconds at_most);

 private:
  using Clock = Pace::Clock;
  using Json = nlohmann::ordered_json;
  using Timeline = TimelineOf<Run>;

  void restart();
  void tick();
  ProblemFrame drive(Run& run);
  void keep(ProblemFrame frame);
  void publish(int tick);
  void show_step(int tick);
  void continue_from_shown();
  void perform(const Timeline::Action& action);
  bool is_held() const;
  const Run& present();
  const Run& shown() { return viewed_ >= 0 ? present() : *run_; }
  int shown_tick() const { return viewed_ >= 0 ? viewed_ : timeline_.newest(); }
  Clock::duration until_due() const;

  void obey(std::uint64_t client, const std::string& what, const Json& command);
  void set(const std::string& key, const std::string& value);
  void set_method(const std::string& method);
  void join(std::uint64_t client);
  void tell_past(std::uint64_t client, int from, int to);
  Json hello() const;
  Json state();
  Json options();

  Server& server_;
  Audience audience_;
  std::optional<Run> run_;
  Timeline timeline_;
  std::optional<Run> held_;  ///< when the step that is shown began, while it is held
  std::vector<std::string> methods_;
  std::map<std::string, SolverOptions> loaded_;    ///< options of each method before changes
  std::map<std::string, std::string> parameters_;  ///< parameters of the problem before changes
  Bounds bounds_;
  std::vector<int> collided_;  ///< steps that collided
  std::string told_options_;   ///< message with the options that the pages have
  Pace pace_;
  double rate_ = 1, measured_rate_ = 0;  ///< simulated to real time
  double solve_time_ = 0;                ///< s of wall clock
  std::size_t copy_bytes_ = 0;           ///< about the size of a copy of the run
  bool paused_ = false, waiting_ = true, edited_ = false, is_state_changed_ = true;
  int viewed_ = -1;     ///< step that is shown while it is not the newest
  int steps_left_ = 0;  ///< steps of a command "step" to come
  int generation_ = 0;  ///< number of drives that have begun
  Clock::time_point last_state_ = Clock::now(), last_frame_ = last_state_;
};

}  // namespace slalom::view
