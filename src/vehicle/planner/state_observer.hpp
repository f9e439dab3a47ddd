#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "slalom/vehicle/model/vehicle_model.hpp"

namespace slalom::vehicle::detail {

/// The state of a car whose tyres slip: pose and speed from odometry, steering angle, yaw rate and slip by
/// the model and the commands sent, corrected by how far the pose moved otherwise than predicted. Commands
/// are sent once per control period; a speed takes effect after `latency`, a steering angle `dead_time`
/// later.
class StateObserver {
 public:
  /// s; latency and dead time together at most 32 periods.
  StateObserver(double period, double latency, double dead_time)
      : period_(period), latency_(latency), delay_(latency + dead_time) {}

  void reset() noexcept { *this = StateObserver(period_, latency_, delay_ - latency_); }

  /// The state at the time of the odometry.
  const VehicleStart& now() const noexcept { return now_; }

  /// Takes the odometry one period after the last.
  void update(const VehicleModel& model, const maps::Pose& pose, double speed) noexcept {
    const VehicleStart before = now_;
    VehicleStart predicted = before;
    predict(model, predicted, -period_, 0);
    now_ = predicted;
    now_.pose = pose;
    now_.speed = speed;
    const double c = std::cos(before.pose.yaw), s = std::sin(before.pose.yaw);
    const double dx = pose.x - predicted.pose.x, dy = pose.y - predicted.pose.y;
    const double aside = (c * dy - s * dx) / period_,
                 turned = maps::wrap_angle(pose.yaw - predicted.pose.yaw) / period_;
    const bool continues = known_ && std::hypot(dx, dy) < farthest && std::abs(turned) * period_ < farthest;
    known_ = true;
    const double wheelbase = model.traits().wheelbase, rear = model.traits().rear_length;
    if (!continues || std::abs(speed) < slow) {
      now_.yaw_rate = speed * std::tan(now_.steer) / wheelbase;
      now_.slip = std::atan(rear * std::tan(now_.steer) / wheelbase);
      return;
    }
    now_.yaw_rate = predicted.yaw_rate + yaw_rate_gain * turned;
    // The rear axle's sideways velocity differs from the centre of gravity's by the turning.
    now_.slip = predicted.slip + slip_gain * (aside + rear * turned) / speed;
    now_.slip = std::clamp(now_.slip, -1.2, 1.2);
  }

  /// Records the command that is sent now; for the next update.
  void send(const Command& command) noexcept {
    for (std::size_t i = sent_.size() - 1; i > 0; --i) sent_[i] = sent_[i - 1];
    sent_[0] = command;
  }

  /// The state when the next command takes effect on the steering.
  VehicleStart ahead(const VehicleModel& model) const noexcept {
    VehicleStart car = now_;
    predict(model, car, 0, delay_);
    return car;
  }
  /// The speed (m/s) when the next command takes effect on it.
  double speed_ahead(const VehicleModel& model) const noexcept {
    VehicleStart car = now_;
    predict(model, car, 0, latency_);
    return car.speed;
  }

 private:
  /// Of the way from the predicted to the observed.
  static constexpr double yaw_rate_gain = 0.5, slip_gain = 0.3;
  static constexpr double farthest = 0.5;  ///< m or rad; a pose further from the predicted one was reset
  static constexpr double slow = 0.5;      ///< m/s, below it the car is a kinematic bicycle

  /// From `begin` to `end`, s after the last odometry.
  void predict(const VehicleModel& model, VehicleStart& car, double begin, double end) const noexcept {
    constexpr double piece = 0.005;  // s
    const int pieces = static_cast<int>(std::ceil((end - begin) / piece - 1e-9));
    for (int i = 0; i < pieces; ++i) {
      const double dt = (end - begin) / pieces, middle = begin + (i + 0.5) * dt;
      car = model.advance(car, {acting(middle, delay_).steer, acting(middle, latency_).speed}, dt);
    }
  }
  /// The command that acts with this delay at a time, s after the last odometry; the newest was sent one
  /// period before.
  const Command& acting(double time, double delay) const noexcept {
    const double periods = std::ceil((delay - time) / period_) - 1;
    return sent_[static_cast<std::size_t>(std::clamp(periods, 0.0, double(sent_.size() - 1)))];
  }

  static constexpr std::array<Command, 36> none_sent() {
    std::array<Command, 36> commands{};
    for (Command& each : commands) each.speed = std::numeric_limits<double>::quiet_NaN();
    return commands;
  }

  double period_, latency_, delay_;
  std::array<Command, 36> sent_ = none_sent();
  VehicleStart now_;
  bool known_ = false;  ///< whether there was odometry before
};

}  // namespace slalom::vehicle::detail
