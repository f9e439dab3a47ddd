#pragma once

#include "slalom/maps/pose.hpp"
#include "slalom/navigation/base.hpp"

namespace slalom::navigation::detail {

/// Commands that have not taken effect yet, and the delay if none is told: the one with which the commands
/// differ least from the measured velocities, in units of the limits. All axes get the delay of the slowest
/// one: commands of the others are sent later by the difference. So a decision takes effect as a whole.
class CommandDelay {
 public:
  explicit CommandDelay(const BaseOptions& base) noexcept;

  double longest() const noexcept { return longest_; }  ///< s until a decision takes effect
  const Velocity& decided() const noexcept { return decided_; }
  void clear() noexcept { *this = CommandDelay(base_); }

  /// The last decision was in force for so long (s), and now the robot has this velocity.
  void pass(const Velocity& measured, double elapsed) noexcept;
  /// The velocity between the last decision and the measured one: the nearer to the measured one, the
  /// steadier the differences of both have been. Noise in the measured velocity does not reach the plans.
  const Velocity& likely() const noexcept { return likely_; }
  /// The pose at which the next decision takes effect.
  maps::Pose predict(maps::Pose pose) const noexcept;
  /// Takes a decision, and returns what to send now.
  Velocity send(const Velocity& decision) noexcept;

 private:
  struct Entry {
    Velocity command;
    double duration = 0;  ///< s
  };
  const Entry& entry(std::size_t age) const noexcept;
  Velocity before(double age) const noexcept;

  /// The differences of an axis from the decisions.
  struct Differences {
    double mean = 0, square = 0, last = 0;
    double likely(double decided, double measured, double kept) noexcept;
  };
  void estimate(const Velocity& measured, double elapsed) noexcept;
  double difference(const Velocity& a, const Velocity& b) const noexcept;

  static constexpr double delay_step = 0.05;    ///< s between the delays that are compared
  static constexpr double memory = 10;          ///< s
  static constexpr double steady_after = 0.25;  ///< s
  static constexpr double clear_share = 0.5;    ///< largest share of the error without a delay

  BaseOptions base_;
  double forward_, left_, turn_, longest_;
  bool estimates_ = false;
  double per_speed_ = 1, per_turn_ = 1;
  std::array<double, 21> errors_{};  ///< s, of each delay that is compared
  double motion_ = 0;                ///< s
  Velocity decided_, likely_;
  std::array<Differences, 3> axes_{};
  std::array<Entry, 512> entries_{};
  std::size_t next_ = 0, count_ = 0;
};

}  // namespace slalom::navigation::detail
