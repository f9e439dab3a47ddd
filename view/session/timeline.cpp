#include "view/session/timeline.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slalom::view {
namespace {

constexpr std::size_t max_frame_bytes = 400u << 20;
constexpr std::size_t max_copy_bytes = 1u << 30;
constexpr std::size_t max_copies = 48;

}  // namespace

Timeline::Timeline(double control_period)
    : most_steps_(static_cast<std::ptrdiff_t>(stored_seconds / control_period)),
      ticks_per_copy_(std::max(1, static_cast<int>(std::lround(1 / control_period)))) {}

void Timeline::checkpoint(const Drives& drives, std::size_t copy_bytes) {
  if (!copies_.empty() && drives.ticks() - copies_.back().ticks() < ticks_per_copy_) return;
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

void Timeline::show(std::shared_ptr<const std::string> frame) {
  bytes_ += frame->size() - steps_.back().frame->size();
  steps_.back().frame = std::move(frame);
}

Drives Timeline::after(int tick) const {
  const auto later = std::ranges::find_if(copies_, [&](const Drives& each) { return each.ticks() > tick; });
  Drives drives = *std::prev(later);
  auto noted = std::ranges::find_if(actions_, [&](const auto& each) { return each.first > drives.ticks(); });
  while (drives.ticks() <= tick) {
    for (; noted != actions_.end() && noted->first <= drives.ticks(); ++noted) noted->second(drives);
    drives.tick(at(drives.ticks()).delays);
  }
  return drives;
}

void Timeline::forget_after(int tick) {
  for (; newest() > tick; steps_.pop_back()) bytes_ -= steps_.back().frame->size();
  while (copies_.size() > 1 && copies_.back().ticks() > tick) copies_.pop_back();
  std::erase_if(actions_, [&](const auto& each) { return each.first > tick; });
}

}  // namespace slalom::view
