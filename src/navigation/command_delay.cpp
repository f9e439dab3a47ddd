#include "navigation/command_delay.hpp"

#include <utility>

namespace slalom::navigation::detail {

CommandDelay::CommandDelay(const BaseOptions& base) noexcept
    : base_(base), forward_(base.delay_forward), left_(base.delay_sideways), turn_(base.delay_turn) {
  longest_ = std::max(forward_, turn_);
  if (base.kind == BaseKind::omnidirectional) longest_ = std::max(longest_, left_);
  estimates_ = longest_ == 0;
  per_speed_ = 1 / base.max_forward;
  per_turn_ = 1 / std::max(base.max_turn, 0.01);
}

void CommandDelay::pass(const Velocity& measured, double elapsed) noexcept {
  next_ = (next_ + 1) % entries_.size();
  count_ = std::min(count_ + 1, entries_.size());
  entries_[next_] = {decided_, elapsed};
  const double kept = std::exp(-elapsed / steady_after);
  likely_ = {axes_[0].likely(decided_.forward, measured.forward, kept),
             axes_[1].likely(decided_.left, measured.left, kept),
             axes_[2].likely(decided_.turn, measured.turn, kept)};
  if (count_ == 1) likely_ = measured;  // it follows from no decision yet
  if (estimates_) estimate(measured, elapsed);
}

/// Weighs the difference by the share of its squared mean in its mean square. What repeats to the bit has no
/// noise.
double CommandDelay::Differences::likely(double decided, double measured, double kept) noexcept {
  const double difference = measured - decided;
  mean = std::lerp(difference, mean, kept);
  square = std::lerp(difference * difference, square, kept);
  const bool repeats = std::exchange(last, measured) == measured;
  return square > 0 && !repeats ? std::lerp(decided, measured, mean * mean / square) : measured;
}

maps::Pose CommandDelay::predict(maps::Pose pose) const noexcept {
  std::size_t used = 0;
  double covered = 0;
  while (used < count_ && covered < longest_) covered += entry(used++).duration;
  double first = std::max(covered - longest_, 0.0);  // s of the oldest entry that are over
  for (std::size_t age = used; age-- > 0; first = 0) {
    const auto& [command, duration] = entry(age);
    pose = moved(pose, command, std::max(duration - first, 0.0));
  }
  return pose;
}

Velocity CommandDelay::send(const Velocity& decision) noexcept {
  decided_ = decision;
  if (estimates_) return decision;
  return {before(longest_ - forward_).forward, before(longest_ - left_).left, before(longest_ - turn_).turn};
}

/// The entry of this age; 0 is the last one.
const CommandDelay::Entry& CommandDelay::entry(std::size_t age) const noexcept {
  return entries_[(next_ + entries_.size() - age) % entries_.size()];
}

/// The decision that was in force so long (s) ago.
Velocity CommandDelay::before(double age) const noexcept {
  const double rounding = 1e-9;  // s
  for (std::size_t i = 0; age > rounding; ++i) {
    if (i == count_) return {};
    age -= entry(i).duration;
    if (age <= rounding) return entry(i).command;
  }
  return decided_;
}

void CommandDelay::estimate(const Velocity& measured, double elapsed) noexcept {
  const double kept = std::exp(-elapsed / memory);
  std::size_t age = 0, best = 0;
  double end = 0;  // s ago, until which the entry was in force
  for (std::size_t k = 0; k < errors_.size(); ++k) {
    while (age < count_ && end + entry(age).duration < delay_step * (static_cast<double>(k) + 0.5))
      end += entry(age++).duration;
    const Velocity command = age < count_ ? entry(age).command : Velocity{};
    errors_[k] = kept * errors_[k] + elapsed * difference(measured, command);
    if (errors_[k] < errors_[best]) best = k;
  }
  motion_ = kept * motion_ + elapsed * difference(measured, {});
  // It is clear once the robot has moved as much as in a delay at full speed.
  if (errors_[best] < clear_share * errors_[0] && motion_ > delay_step) longest_ = delay_step * best;
}

double CommandDelay::difference(const Velocity& a, const Velocity& b) const noexcept {
  const double forward = per_speed_ * (a.forward - b.forward), left = per_speed_ * (a.left - b.left),
               turn = per_turn_ * (a.turn - b.turn);
  return forward * forward + left * left + turn * turn;
}

}  // namespace slalom::navigation::detail
