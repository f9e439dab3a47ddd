#pragma once

#include <array>

#include "slalom/vehicle/model/vehicle_problem.hpp"

namespace slalom::vehicle::detail {

/// Remembers the steering commands that were sent, one per control period. Each takes effect after a delay.
/// Predicts the car until a new command can take effect, and the wheels' angle, which is not measured.
class CommandHistory {
 public:
  /// All times in s, wheelbase in m; `delay` is at most 32 periods, `time_constant` that of the steering.
  CommandHistory(double period, double delay, double time_constant, double wheelbase);

  void reset() noexcept;

  /// The wheels' angle now, rad.
  double steer() const noexcept { return steer_; }

  /// Records a command that is sent now, and advances by one period.
  void send(double steer) noexcept;

  /// Predicts the state when the next command takes effect, at constant speed.
  VehicleStart lead_ahead(VehicleStart car) const noexcept;

 private:
  template <class Act>
  void for_each_acting(double begin, double end, int newest, Act&& act) const noexcept;
  void turn_wheels(double& steer, double command, double duration) const noexcept;

  double period_, delay_, time_constant_, wheelbase_;
  std::array<double, 34> sent_{};
  double steer_ = 0;
};

}  // namespace slalom::vehicle::detail
