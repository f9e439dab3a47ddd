#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "slalom/maps/pose.hpp"
#include "slalom/navigation/base.hpp"

namespace slalom::navigation::detail {

/// Commands that have not taken effect yet, and the delay if none is told: the one with which the commands
/// differ least from the measured velocities, in units of the limits. All axes get the delay of the slowest
/// one: commands of the others are sent later by the difference. So a decision takes effect as a whole.
class CommandDelay {
 public:
  explicit CommandDelay(const BaseOptions& base) noexcept
      : forward_(base.delay_forward), left_(base.delay_sideways), turn_(base.delay_turn) {
    longest_ = std::max(forward_, turn_);
    if (base.kind == BaseKind::omnidirectional) longest_ = std::max(longest_, left_);
    estimates_ = longest_ == 0;
    per_speed_ = 1 / base.max_forward;
    per_turn_ = 1 / std::max(base.max_turn, 0.01);
  }

  double longest() const noexcept { return longest_; }  ///< s until a decision takes effect
  const Velocity& decided() const noexcept { return decided_; }
  void clear() noexcept {
    count_ = 0;
    decided_ = {};
    errors_.fill(0);
    motion_ = 0;
    if (estimates_) longest_ = 0;
  }

  /// The last decision was in force for so long (s), and now the robot has this velocity.
  void pass(const Velocity& measured, double elapsed) noexcept {
    next_ = (next_ + 1) % entries_.size();
    count_ = std::min(count_ + 1, entries_.size());
    entries_[next_] = {decided_, elapsed};
    if (estimates_) estimate(measured, elapsed);
  }
  /// The pose at which the next decision takes effect.
  maps::Pose predict(maps::Pose pose) const noexcept {
    std::size_t used = 0;
    double covered = 0;
    while (used < count_ && covered < longest_) covered += entry(used++).duration;
    double first = std::max(covered - longest_, 0.0);  // s of the oldest entry that are over
    for (std::size_t age = used; age-- > 0; first = 0) {
      const auto& [command, duration] = entry(age);
      const double time = std::max(duration - first, 0.0), yaw = pose.yaw + 0.5 * time * command.turn;
      const double c = std::cos(yaw), s = std::sin(yaw);
      pose = {pose.x + time * (c * command.forward - s * command.left),
              pose.y + time * (s * command.forward + c * command.left), pose.yaw + time * command.turn};
    }
    return pose;
  }
  /// Takes a decision, and returns what to send now.
  Velocity send(const Velocity& decision) noexcept {
    decided_ = decision;
    if (estimates_) return decision;
    return {before(longest_ - forward_).forward, before(longest_ - left_).left,
            before(longest_ - turn_).turn};
  }

 private:
  struct Entry {
    Velocity command;
    double duration = 0;  ///< s
  };
  /// The entry of this age; 0 is the last one.
  const Entry& entry(std::size_t age) const noexcept {
    return entries_[(next_ + entries_.size() - age) % entries_.size()];
  }
  /// The decision that was in force so long (s) ago.
  Velocity before(double age) const noexcept {
    constexpr double rounding = 1e-9;  // s
    for (std::size_t i = 0; age > rounding; ++i) {
      if (i == count_) return {};
      age -= entry(i).duration;
      if (age <= rounding) return entry(i).command;
    }
    return decided_;
  }

  void estimate(const Velocity& measured, double elapsed) noexcept {
    const double kept = std::exp(-elapsed / memory);
    std::size_t age = 0, best = 0;
    double end = 0;  // s ago, until which the entry was in force
    for (std::size_t k = 0; k < delays; ++k) {
      while (age < count_ && end + entry(age).duration < delay_step * (static_cast<double>(k) + 0.5))
        end += entry(age++).duration;
      const Velocity command = age < count_ ? entry(age).command : Velocity{};
      errors_[k] = kept * errors_[k] + elapsed * difference(measured, command);
      if (errors_[k] < errors_[best]) best = k;
    }
    motion_ = kept * motion_ + elapsed * difference(measured, {});
    const bool is_clear = errors_[best] < clear_share * errors_[0];
    if (is_clear && errors_[0] > least_error && motion_ > least_error) longest_ = delay_step * best;
  }
  double difference(const Velocity& a, const Velocity& b) const noexcept {
    const double forward = per_speed_ * (a.forward - b.forward), left = per_speed_ * (a.left - b.left),
                 turn = per_turn_ * (a.turn - b.turn);
    return forward * forward + left * left + turn * turn;
  }

  static constexpr std::size_t delays = 21;    // that are compared
  static constexpr double delay_step = 0.05;   // s between them
  static constexpr double memory = 10;         // s
  static constexpr double clear_share = 0.5;   // largest share of the error without a delay
  static constexpr double least_error = 0.01;  // s, of a squared share of the limits

  double forward_, left_, turn_, longest_;
  bool estimates_ = false;
  double per_speed_ = 1, per_turn_ = 1;
  std::array<double, delays> errors_{};  ///< s, of each delay
  double motion_ = 0;                    ///< s
  Velocity decided_;
  std::array<Entry, 512> entries_{};
  std::size_t next_ = 0, count_ = 0;
};

}  // namespace slalom::navigation::detail
