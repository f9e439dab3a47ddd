#pragma once

#include <algorithm>
#include <chrono>

#include "view/protocol/messages.hpp"
#include "view/server/audience.hpp"
#include "view/session/drives.hpp"
#include "view/session/timeline.hpp"

namespace slalom::view {

constexpr auto min_frame_gap = std::chrono::milliseconds(12);  ///< no screen shows more
constexpr auto max_state_gap = std::chrono::seconds(1);        ///< between two messages of the state

/// Tells when the next step of a drive is due, and measures how fast the drive goes. `rate`: simulated to
/// real time, 0 for the maximum speed; `period`: s of a step.
struct Pace {
  using Clock = std::chrono::steady_clock;
  Clock::time_point due = Clock::now();
  Clock::time_point since = due;  ///< from when the pace is measured
  int steps = 0;                  ///< since then

  Clock::duration until_due(double rate) const {
    return rate > 0 ? due - Clock::now() : Clock::duration::zero();
  }
  /// Notes that a step begins.
  void step(double period, double rate) {
    ++steps;
    if (rate <= 0) return;
    constexpr int max_late_steps = 4;  // that a late clock may owe
    const auto step =
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(period / rate));
    due = std::max(due + step, Clock::now() - max_late_steps * step);
  }
  /// Returns the simulated time per time; `before`, the last one, if too little time has passed.
  double measure(double before, double period, bool paused) {
    constexpr double least = 0.5;  // s
    const double passed = std::chrono::duration<double>(Clock::now() - since).count();
    if (passed < least && !paused) return before;
    const double pace = paused ? 0 : steps * period / passed;
    since = Clock::now();
    steps = 0;
    return pace;
  }
  /// Whether a person waits for the next step.
  static bool is_slow(double period, double rate) { return rate > 0 && period > 0.05 * rate; }
};

/// A drive as it is stored: its messages in their order, and what names the file that they are written to.
struct StoredDrive {
  std::string hello, options, state;
  std::shared_ptr<const std::string> scene;  ///< empty without map and course
  std::vector<DrivenTick> ticks;
  std::string name, command_line;
  std::optional<Scanner> scanner;
};

struct SessionOptions {
  ScenarioNames scenario{};
  /// Loads another scenario and completes its names. Throws errors for the user. Without it, the page cannot
  /// choose one.
  std::function<std::unique_ptr<Subject>(ScenarioNames&)> load{};
  Choices choices{};
  std::string further_arguments{};  ///< arguments of the equivalent command line; begins with a space
  std::string against{};            ///< method of a ghost from the start, if any
  bool introduction = false;        ///< whether the server has the page of the introduction
  Packing packing{};                ///< form of stored frames
  /// Writes a file, perhaps in a thread of its own, and sends it to a page with `send`. `what`: recording or
  /// replay. Without it, the page cannot save a drive. Throws errors for the user.
  std::function<void(const std::string& what, StoredDrive drive, std::function<void(Message)> send)> save{};
};

/// Drives a subject for the pages that are open, and executes the commands of the one that drives; the others
/// watch, and can take over. The drive pauses, goes back to any stored step and continues from there.
/// Everything happens in the thread that calls `turn`, which never waits for a client.
class Session {
 public:
  /// Throws std::invalid_argument if the subject or the method of the ghost is not valid.
  Session(std::unique_ptr<Subject> subject, Server& server, SessionOptions options = {});

  /// Executes the commands received, and drives one step if it is due; waits for one, for `at_most` at most.
  void turn(std::chrono::nanoseconds at_most = {});
  /// Drives until the drive has some steps, and returns it. For a session without a page.
  StoredDrive record(int steps);
  /// Number of messages that were not valid commands.
  std::uint64_t refused() const noexcept { return audience_.refused(); }
  /// Whether ticks of a command "step" are left.
  bool is_busy() const noexcept { return steps_left_ > 0; }

 private:
  using Clock = Pace::Clock;
  using Json = nlohmann::ordered_json;
  using Shapes = std::vector<Shape>;
  /// The options or the shapes that a change has replaced after some ticks.
  struct Change {
    int ticks;
    std::variant<Settings, Shapes> before;
  };

  // Driving.
  void install(std::unique_ptr<Subject> subject);
  void begin(Drives drives);
  void tick();
  DrivenTick drive(Drives& drives, int solves);
  Frame drive(Run& run, StepRecord& record, double& update_time);
  void keep(DrivenTick tick);

  // Time.
  Clock::duration until_due() const;
  int shown_tick() const { return viewed_ >= 0 ? viewed_ : timeline_.newest(); }
  bool is_held() const;
  Drives& present(int lead = 0);
  bool approach(int lead);
  bool prepare_change();
  void continue_from_shown();
  void forget_after(int tick, int ticks);
  void show_step(int tick);
  void offer_newest();
  void publish_newest();

  // Changing the drive, from the tick that is shown on.
  void perform(const Action& action, int lead = 0);
  void remember(decltype(Change::before) before, int drag = 0);
  void undo(bool again);
  Shapes shapes();
  SolverOptions options_for(const std::string& method);
  void change_options(const Action& action);
  void fork(const Json& command);
  void set_ghost(const std::string& method);

  // Commands.
  void obey(std::uint64_t client, const std::string& what, const Json& command);
  bool obey_transport(const std::string& what, const Json& command);
  bool obey_edit(const std::string& what, const Json& command);
  bool obey_options(const std::string& what, const Json& command);
  void save(std::uint64_t client, const std::string& what);

  // Messages.
  void join(std::uint64_t client);
  void tell();
  std::string hello() const;
  std::string state() const;
  OptionsFacts options_facts() const;
  StoredDrive stored() const;

  const SubjectFacts& facts() const { return drives_->driven.subject->facts(); }
  double control_period() const { return drives_->driven.period; }
  /// The method and options of the step that is shown.
  const Settings& settings() const {
    return viewed_ >= 0 ? *timeline_.at(viewed_).settings : *drives_->driven.settings;
  }

  Server& server_;
  Audience audience_;
  SessionOptions options_;
  DriveState state_;  ///< `state` fills in what follows from drives and timeline
  std::optional<Drives> drives_;
  Timeline timeline_;
  std::optional<Drives> held_;  ///< while nothing moves: what a change last applied to, with the change
  OptionTexts loaded_;          ///< values of all options without changes
  std::shared_ptr<const std::string> scene_;  ///< message with map and course; empty if there is neither
  std::vector<Change> undo_, redo_;           ///< changes to undo and to do again, newest last
  int acted_ = 0;                             ///< ticks before the last change
  int drag_ = 0;                              ///< the drag of the last change
  std::string told_options_;                  ///< message with the options that the pages have

  Pace pace_;
  bool is_state_changed_ = true;
  bool waiting_ = true;                   ///< for the first page to be opened
  bool is_prepared_ = true;               ///< whether a change after a pause need not wait
  bool is_newest_sent_ = true;            ///< false if the newest step came too early for a frame
  int viewed_ = -1;                       ///< step that is shown while it is not the newest
  int steps_left_ = 0;                    ///< steps of a command "step" that are still to come
  std::size_t laps_ = 0;                  ///< number of laps that have ended
  std::array<double, 2> last_updates_{};  ///< s of wall clock, of what is driven and of the ghost
  Clock::time_point last_state_ = Clock::now(), last_frame_ = last_state_;
};

}  // namespace slalom::view
