#pragma once

#include <functional>
#include <map>
#include <string>

#include "bridge/bridge.hpp"
#include "bridge/frames.hpp"
#include "bridge/input_watch.hpp"
#include "bridge/report.hpp"
#include "bridge/throttled_log.hpp"

namespace slalom_bridge {

/// The simulator as a car, without the transport of its messages. Like a real car it must brake without a
/// finite command for a while, or when two nodes command it. No function throws unless it says so.
class WorldCore {
 public:
  static constexpr Stamp period = 25'000'000;  ///< ns, of a step

  struct Settings {
    std::string course = "wren";   ///< a name or a folder
    std::uint64_t seed = 1;        ///< of noise and parked cars
    int obstacles = 5;             ///< number of parked cars
    double command_timeout = 0.2;  ///< s, after which it brakes
  };

  /// `warn` writes to the log. Throws std::exception with a message for the user.
  WorldCore(const Settings& settings, Clocks clocks, std::function<void(const std::string&)> warn);

  const Course& course() const { return course_; }
  const World& world() const { return world_; }

  /// A command (rad, m/s) of a node; `voice` names the node.
  void hear_drive(const std::string& voice, double steer, double speed);
  /// Puts the car back to the start.
  void reset() { world_.reset(); }

  /// To be called every millisecond or so. Makes a step if one is due; then returns true, and `world` has
  /// what the car measures at the time `stamp`.
  bool step_if_due(Stamp& stamp);
  /// Whether the parked cars and the car are to be marked with this step. A display discards markers that it
  /// has no transform for yet, so they are repeated each second.
  bool marks_due() const { return steps_ % marks_every == 1; }

  /// What happened since the last report.
  Report report();

 private:
  static constexpr int marks_every = 40;  ///< steps

  bool commanded();

  Clocks clocks_;
  ThrottledLog log_;
  Settings settings_;
  Course course_;
  World world_;
  double steer_ = 0, speed_ = 0;          ///< rad, m/s
  std::map<std::string, double> voices_;  ///< when each node commanded last, s, steady clock
  Stamp due_ = 0;
  long steps_ = 0;
  std::string why_;  ///< it braked since the last report
};

}  // namespace slalom_bridge
