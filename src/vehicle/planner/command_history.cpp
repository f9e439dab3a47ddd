#include "vehicle/planner/command_history.hpp"

#include <algorithm>
#include <cmath>

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::vehicle::detail {

CommandHistory::CommandHistory(double period, double delay, double time_constant, double wheelbase)
    : period_(period), delay_(delay), time_constant_(time_constant), wheelbase_(wheelbase) {}

void CommandHistory::reset() noexcept {
  sent_.fill(0);
  steer_ = 0;
}

void CommandHistory::send(double steer) noexcept {
  for (std::size_t i = sent_.size() - 1; i > 0; --i) sent_[i] = sent_[i - 1];
  sent_[0] = steer;
  for_each_acting(-delay_, period_ - delay_, 1,
                  [&](double command, double duration) { turn_wheels(steer_, command, duration); });
}

VehicleStart CommandHistory::lead_ahead(VehicleStart car) const noexcept {
  for_each_acting(-delay_, 0, 0, [&](double command, double duration) {
    const int pieces = saturate_cast<int>(std::ceil(duration / 0.01 - 1e-9));
    for (int i = 0; i < pieces; ++i) {
      const double dt = duration / pieces, before = car.steer;
      turn_wheels(car.steer, command, dt);
      const double turned = car.speed * dt * std::tan(0.5 * (before + car.steer)) / wheelbase_;
      car.pose.x += car.speed * dt * std::cos(car.pose.yaw + 0.5 * turned);
      car.pose.y += car.speed * dt * std::sin(car.pose.yaw + 0.5 * turned);
      car.pose.yaw += turned;
    }
  });
  return car;
}

/// Calls `act(command, duration)` for the commands sent from `begin` to `end` (s). If `newest` is 1, time 0
/// is when the newest command was sent; if it is 0, one period later.
template <class Act>
void CommandHistory::for_each_acting(double begin, double end, int newest, Act&& act) const noexcept {
  const int oldest =
      std::min(static_cast<int>(sent_.size()) - 1, saturate_cast<int>(std::ceil(-begin / period_) + 1));
  for (int i = oldest; i >= 0; --i) {
    const double sent = -(i + 1 - newest) * period_;
    const double from = std::max(begin, sent), to = std::min(end, sent + period_);
    if (to > from + 1e-12) act(sent_[i], to - from);
  }
}

void CommandHistory::turn_wheels(double& steer, double command, double duration) const noexcept {
  steer += (command - steer) * (1 - std::exp(-duration / time_constant_));
}

}  // namespace slalom::vehicle::detail
