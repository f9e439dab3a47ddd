#include "view/session/timeline.hpp"

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include "view/protocol/frame_writer.hpp"

namespace slalom::view {
namespace {

constexpr int max_ticks_per_message = 800;
constexpr std::size_t max_copies = 128;  // a second apart

}  // namespace

std::size_t allocated_bytes() {
#if defined(__GLIBC__)
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
#else
  return 0;
#endif
}

void DrivenTick::keep_scalars(std::size_t count) {
  scalars = frame->substr(FrameWriter::head_bytes, 8 * count);
}

void DrivenTick::pack(const Packing& packing) {
  if (!packing.pack || is_packed) return;
  frame = shared(packing.pack(*frame));
  is_packed = true;
}

std::shared_ptr<const std::string> DrivenTick::message(const Packing& packing) const {
  return is_packed ? shared(packing.unpack(*frame)) : frame;
}

std::size_t DrivenTick::bytes() const noexcept {
  return sizeof *this + scalars.capacity() + (frame ? frame->capacity() : 0);
}

Timeline::Timeline(double control_period, Packing packing)
    : most_ticks_(static_cast<int>(stored_seconds / control_period)),
      ticks_per_copy_(std::max(1, static_cast<int>(std::lround(1 / control_period)))),
      packing_(packing) {}

void Timeline::checkpoint(const Drives& drives) {
  if (!copies_.empty() && drives.ticks() - copies_.back().drives.ticks() < ticks_per_copy_) return;
  const std::size_t before = allocated_bytes();
  copies_.push_back({drives, 0});
  const std::size_t after = allocated_bytes();
  copies_.back().bytes = after > before ? after - before : 0;
  while (copies_.size() > max_copies || (copies_.size() > 3 && copy_bytes() > max_copy_bytes)) thin_out();
}

void Timeline::note(int ticks, Action action) {
  const auto later =
      std::find_if(actions_.begin(), actions_.end(), [&](const auto& each) { return each.first > ticks; });
  actions_.emplace(later, ticks, std::move(action));
}

void Timeline::act(Drives& drives) const {
  const int ticks = drives.ticks();
  for (const auto& [noted, action] : actions_)
    if (noted == ticks) action(drives);
}

void Timeline::keep(DrivenTick tick) {
  if (!empty()) {
    frame_bytes_ -= ticks_.back().bytes();
    ticks_.back().pack(packing_);
    frame_bytes_ += ticks_.back().bytes();
  } else {
    oldest_ = tick.tick;
  }
  ticks_.push_back(std::move(tick));
  frame_bytes_ += ticks_.back().bytes();
  while (newest() > oldest_ && (newest() - oldest_ >= most_ticks_ || frame_bytes_ > max_frame_bytes))
    forget_oldest();
}

std::vector<DrivenTick> Timeline::stored() const {
  return {ticks_.begin() + (oldest() - (empty() ? -1 : ticks_.front().tick)), ticks_.end()};
}

std::size_t Timeline::copy_bytes() const noexcept {
  std::size_t sum = 0;
  for (const Copy& each : copies_) sum += each.bytes;
  return sum;
}

std::string Timeline::past(int from, int to) const {
  FrameWriter past;
  past.begin(Block::past);
  to = std::min(to, newest());
  from = empty() ? to + 1 : std::max({from, oldest(), to - max_ticks_per_message + 1});
  for (; from <= to; ++from) past.append(at(from).scalars);
  past.end();
  return past.take();
}

bool Timeline::approach(std::optional<Drives>& drives, int tick) const {
  if (drives && drives->ticks() == tick) return true;
  const auto later =
      std::find_if(copies_.begin(), copies_.end(), [&](const Copy& c) { return c.drives.ticks() > tick; });
  const Drives& copy = std::prev(later)->drives;
  if (!drives || drives->ticks() > tick || drives->ticks() < copy.ticks()) {
    drives = copy;
  } else {
    drives->tick(at(drives->ticks()).records);
    act(*drives);
  }
  return drives->ticks() == tick;
}

void Timeline::forget_after(int tick, int ticks) {
  for (; newest() > tick; ticks_.pop_back()) frame_bytes_ -= ticks_.back().bytes();
  if (newest() < oldest_) ticks_.clear();
  while (!copies_.empty() && copies_.back().drives.ticks() > tick) copies_.pop_back();
  std::erase_if(actions_, [&](const auto& each) { return each.first > ticks; });
}

/// Forgets the copy, but for the oldest and the newest one, that is the least use for its age.
void Timeline::thin_out() {
  const int now = copies_.back().drives.ticks();
  const auto use = [&](std::size_t i) {
    const double gap = copies_[i + 1].drives.ticks() - copies_[i - 1].drives.ticks();
    return gap / (ticks_per_copy_ + now - copies_[i].drives.ticks());
  };
  std::size_t least = 1;
  for (std::size_t i = 2; i + 1 < copies_.size(); ++i)
    if (use(i) < use(least)) least = i;
  copies_.erase(copies_.begin() + static_cast<std::ptrdiff_t>(least));
}

/// Forgets the oldest frame, and the copies, ticks and actions that only led to it.
void Timeline::forget_oldest() {
  DrivenTick& oldest = ticks_[static_cast<std::size_t>(oldest_++ - ticks_.front().tick)];
  frame_bytes_ -= oldest.bytes();
  oldest = {.tick = oldest.tick, .records = oldest.records};
  if (copies_.size() == 1 || (copies_.size() > 1 && copies_[1].drives.ticks() > oldest_)) return;
  if (!copies_.empty()) copies_.pop_front();
  const int first = copies_.empty() ? oldest_ : copies_.front().drives.ticks();
  while (ticks_.front().tick < first) ticks_.pop_front();
  std::erase_if(actions_, [&](const auto& each) { return each.first <= first; });
}

}  // namespace slalom::view
