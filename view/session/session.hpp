#pragma once

#include <functional>
#include <future>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "view/protocol/car_frame.hpp"
#include "view/recording/encodings.hpp"
#include "view/session/drives.hpp"
#include "view/session/playback.hpp"

namespace slalom::view {

/// A scenario, loaded.
struct LoadedScenario {
  std::shared_ptr<const evaluation::Environment> environment;
  vehicle::Configuration configuration;
  evaluation::LapSettings lap;
};

struct SessionOptions {
  ScenarioNames scenario;
  std::function<LoadedScenario(const ScenarioNames&)> load;  ///< throws errors for the user
  Choices choices;
  std::string further_arguments;   ///< arguments of the equivalent command line; begins with a space
  std::string against{};           ///< method of a ghost from the start, if any
  bool introduction = false;       ///< in slow motion until the first obstacle has been passed
  bool record_all = false;         ///< recordings and replays contain everything
  bool record_times = false;       ///< recordings contain wall-clock times
  std::string program = "slalom";  ///< name of the program in recordings
};

/// Drives a car, sends frames to the clients of a server, and executes the commands of the client that
/// drives; the others watch, and can take over.
class Session final : public Playback<Drives> {
 public:
  /// Throws what `load` throws.
  Session(SessionOptions options, Server& server);

  /// Number of messages that were not valid commands.
  std::uint64_t refused() const noexcept { return audience_.refused(); }
  /// Whether ticks of a command "step" are left.
  bool is_busy() const noexcept { return steps_left_ > 0; }

 private:
  static constexpr int scan_lead = 1;  ///< ticks before the one that is shown, whose end made its scan
  /// The options or the bodies that a change has replaced after some ticks.
  struct Change {
    int ticks;
    std::variant<vehicle::Configuration, std::vector<Body>> before;
  };

  // Driving.
  void install(LoadedScenario loaded, const ScenarioNames& names);
  void restart() override;
  void begin(Drives drives);
  void tick() override { drive_tick(true); }
  void drive_tick(bool is_shown);
  void slow_down();
  void note_laps(const evaluation::LapDrive& drive, const std::string& method, bool is_ghost);
  std::string frame_of(const evaluation::LapDrive& drive, const evaluation::ControlStep& step) const;

  // Changing the drive, from the tick that is shown on.
  bool prepare_change() override;
  Packing packing() const override { return {pack, unpack}; }
  void forget_after(int tick, int ticks) override;
  void perform(const std::vector<Action>& actions, int lead = 0);
  void remember(decltype(Change::before) before, int drag = 0);
  void change_driver(const vehicle::Configuration& configuration, const std::string& method);
  void undo(bool again);
  void fork(const Json& command);
  void set_ghost(const std::string& method);

  // Commands.
  void obey(std::uint64_t client, const std::string& what, const Json& command) override;
  bool obey_edit(const std::string& what, const Json& command);
  bool obey_scenario(const std::string& what, const Json& command);
  bool obey_options(const std::string& what, const Json& command);
  void save(std::uint64_t client, const std::string& what);

  // Messages.
  void join(std::uint64_t client) override;
  void tell() override;
  std::string hello() const;
  std::string state() const;
  OptionsFacts options_facts() const;

  const evaluation::LapSetup& setup() const { return drives_->car.setup(); }
  const evaluation::Driver& driver() const { return setup().driver; }
  double control_period() const override { return setup().control_period(); }
  std::size_t scalars() const override { return car_scalars().size(); }

  SessionOptions options_;
  vehicle::Configuration loaded_;  ///< the configuration of the scenario, without changes
  OptionTexts loaded_texts_;       ///< the same as text
  std::shared_ptr<const SubjectFacts> facts_;
  std::shared_ptr<const std::string> scene_;  ///< message with the course
  int acted_ = 0;                             ///< ticks before the last change
  std::vector<Change> undo_, redo_;           ///< changes to undo and to do again, newest last
  int drag_ = 0;                              ///< the drag of the last change
  DriveState state_;                          ///< `state` fills in what follows from drives and timeline

  Delays last_updates_;     ///< s of wall clock
  int passing_ticks_ = -1;  ///< ticks of the introduction since the cars came to the obstacle; -1 before
  bool are_options_changed_ = false;
  std::future<void> saving_;  ///< the last member: its thread ends before what it uses
};

}  // namespace slalom::view
