#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "slalom/maps/pose.hpp"
#include "slalom/navigation/base.hpp"

namespace slalom::navigation::detail {

/// Commands that have not taken effect yet. All axes get the delay of the slowest one: commands of the others
/// are sent later by the difference. So a decision takes effect as a whole.
class CommandDelay {
 public:
  explicit CommandDelay(const BaseOptions& base) noexcept
      : forward_(base.delay_forward), left_(base.delay_sideways), turn_(base.delay_turn) {
    longest_ = std::max(forward_, turn_);
    if (base.kind == BaseKind::omnidirectional) longest_ = std::max(longest_, left_);
  }

  double longest() const noexcept { return longest_; }  ///< s until a decision takes effect
  const Velocity& decided() const noexcept { return decided_; }
  void clear() noexcept {
    count_ = 0;
    decided_ = {};
  }

  /// The last decision was in force for so long (s).
  void pass(double elapsed) noexcept {
    if (longest_ == 0) return;
    next_ = (next_ + 1) % entries_.size();
    count_ = std::min(count_ + 1, entries_.size());
    entries_[next_] = {decided_, elapsed};
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

  double forward_, left_, turn_, longest_;
  Velocity decided_;
  std::array<Entry, 512> entries_{};
  std::size_t next_ = 0, count_ = 0;
};

}  // namespace slalom::navigation::detail
