#include "view/session/timeline.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slalom::view {
namespace {

constexpr std::size_t max_frame_bytes = 400u << 20;
constexpr std::size_t max_copy_bytes = 1u << 30;
constexpr std::size_t max_copies = 200;
constexpr double longest_way = 0.01;  // s of planning from a copy to the tick that is sought

}  // namespace

Timeline::Timeline(double control_period)
    : most_steps_(static_cast<std::ptrdiff_t>(stored_seconds / control_period)),
      ticks_per_copy_(std::max(1, static_cast<int>(std::lround(1 / control_period)))) {}

void Timeline::note(int ticks, Action action) {
  const auto later = std::ranges::find_if(actions_, [&](const auto& each) { return each.first > ticks; });
  actions_.emplace(later, ticks, std::move(action));
}

void Timeline::act(Drives& drives) const {
  const int ticks = drives.ticks();
  for (const auto& [noted, action] : actions_)
    if (noted == ticks) action(drives);
}

void Timeline::checkpoint(const Drives& drives, std::size_t copy_bytes, double tick_time) {
  const double way = copies_.empty() ? 0 : drives.ticks() - copies_.back().ticks();
  if (!copies_.empty() && way < ticks_per_copy_ && way * tick_time < longest_way) return;
  copies_.push_back(drives);
  const std::size_t most = max_copy_bytes / std::max<std::size_t>(1, copy_bytes);
  while (copies_.size() > std::clamp(most, std::size_t{4}, max_copies)) thin_out();
}

/// Forgets the copy among the older half whose neighbours are nearest to each other.
void Timeline::thin_out() {
  std::size_t least = 1;
  const auto gap = [&](std::size_t i) { return copies_[i + 1].ticks() - copies_[i - 1].ticks(); };
  for (std::size_t i = 2; i < copies_.size() / 2; ++i)
    if (gap(i) < gap(least)) least = i;
  copies_.erase(copies_.begin() + static_cast<std::ptrdiff_t>(least));
}

void Timeline::keep(Step step) {
  bytes_ += step.frame->size();
  steps_.push_back(std::move(step));
  const auto is_surplus = [&] {
    return bytes_ > max_frame_bytes || newest() - copies_[1].ticks() >= most_steps_;
  };
  while (copies_.size() > 1 && is_surplus()) forget_oldest();
}

/// Forgets the oldest copy and the ticks up to the next one.
void Timeline::forget_oldest() {
  copies_.pop_front();
  const int first = copies_.front().ticks();
  for (; !empty() && oldest() < first; steps_.pop_front()) bytes_ -= steps_.front().frame->size();
  std::erase_if(actions_, [&](const auto& each) { return each.first <= first; });
}

Drives Timeline::before(int tick) const {
  const auto later = std::ranges::find_if(copies_, [&](const Drives& each) { return each.ticks() > tick; });
  Drives drives = *std::prev(later);
  for (; drives.ticks() < tick; act(drives)) drives.tick(at(drives.ticks()).delays);
  return drives;
}

Drives Timeline::after(int tick) const {
  Drives drives = before(tick);
  drives.tick(at(tick).delays);
  return drives;
}

void Timeline::forget_after(int tick, int ticks) {
  for (; newest() > tick; steps_.pop_back()) bytes_ -= steps_.back().frame->size();
  while (!copies_.empty() && copies_.back().ticks() > tick) copies_.pop_back();
  std::erase_if(actions_, [&](const auto& each) { return each.first > ticks; });
}

}  // namespace slalom::view
