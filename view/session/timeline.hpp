#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "view/protocol/frame_writer.hpp"

namespace slalom::view {

constexpr double stored_seconds = 60;  ///< s of a drive that can be shown again

inline std::shared_ptr<const std::string> shared(std::string text) {
  return std::make_shared<const std::string>(std::move(text));
}

/// The bytes that the process has allocated; 0 where the system does not tell.
std::size_t allocated_bytes();

/// Compresses stored frames, and restores them. Without functions they are stored as they are.
struct Packing {
  std::string (*pack)(std::string_view) = nullptr;
  std::string (*unpack)(std::string_view) = nullptr;
};

/// Delays by which commands take effect later than the settings say, s.
struct Delays {
  double car = 0, ghost = 0;
};

/// A tick that was driven.
struct DrivenTick {
  int tick = 0;
  Delays delays;
  std::shared_ptr<const std::string> frame;  ///< message to the page, or what it is packed to
  std::string scalars{};                     ///< figures with which the message begins
  bool is_packed = false;

  /// Fills in `scalars`, which are the first `count` figures.
  void keep_scalars(std::size_t count) { scalars = frame->substr(FrameWriter::head_bytes, 8 * count); }
  void pack(const Packing& packing);
  std::shared_ptr<const std::string> message(const Packing& packing) const;
  std::size_t bytes() const noexcept;  ///< size of the stored frame
};

/// The past of a drive: the frame of each tick, the actions of the user, and copies of the drives, from which
/// any stored tick is reached again exactly. `Drives` can be copied, and has `int ticks() const` and
/// `void tick(const Delays&)`, which drives one more.
template <class Drives>
class TimelineOf {
 public:
  static constexpr std::size_t max_frame_bytes = 128u << 20;  ///< limit of all stored frames
  static constexpr std::size_t max_copy_bytes = 64u
                                                << 20;  ///< limit of all copies, if there are more than three

  /// An action of a user between two ticks.
  using Action = std::function<void(Drives&)>;

  /// `control_period`: s per tick.
  explicit TimelineOf(double control_period = 1, Packing packing = {})
      : most_ticks_(static_cast<int>(stored_seconds / control_period)),
        ticks_per_copy_(std::max(1, static_cast<int>(std::lround(1 / control_period)))),
        packing_(packing) {}

  /// Keeps a copy of the drives if the last one is a second of the drive's time old, or `now`. To be called
  /// before each tick.
  void checkpoint(const Drives& drives, bool now = false) {
    if (!now && !copies_.empty() && drives.ticks() - copies_.back().drives.ticks() < ticks_per_copy_) return;
    const std::size_t before = allocated_bytes();
    copies_.push_back({drives, 0});
    const std::size_t after = allocated_bytes();
    copies_.back().bytes = after > before ? after - before : 0;
    while (copies_.size() > max_copies || (copies_.size() > 3 && copy_bytes() > max_copy_bytes)) thin_out();
  }
  /// Notes an action after `ticks` ticks, behind those that are noted there.
  void note(int ticks, Action action) {
    const auto later =
        std::find_if(actions_.begin(), actions_.end(), [&](const auto& each) { return each.first > ticks; });
    actions_.emplace(later, ticks, std::move(action));
  }
  /// Applies the actions that are noted for the ticks that drives have.
  void act(Drives& drives) const {
    const int ticks = drives.ticks();
    for (const auto& [noted, action] : actions_)
      if (noted == ticks) action(drives);
  }
  /// Adds the tick that was driven last.
  void keep(DrivenTick tick) {
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

  bool empty() const noexcept { return ticks_.empty(); }
  int oldest() const noexcept { return empty() ? -1 : oldest_; }
  int newest() const noexcept { return empty() ? -1 : ticks_.back().tick; }
  /// Returns a tick that was driven.
  const DrivenTick& at(int tick) const {
    return ticks_.at(static_cast<std::size_t>(tick - ticks_.front().tick));
  }
  /// Returns the message of a stored tick.
  std::shared_ptr<const std::string> frame(int tick) const { return at(tick).message(packing_); }
  /// Returns the ticks that are stored, by age.
  std::vector<DrivenTick> stored() const {
    return {ticks_.begin() + (oldest() - (empty() ? -1 : ticks_.front().tick)), ticks_.end()};
  }
  std::size_t frame_bytes() const noexcept { return frame_bytes_; }  ///< bytes of the stored frames
  /// Returns the bytes of all copies.
  std::size_t copy_bytes() const noexcept {
    std::size_t sum = 0;
    for (const Copy& each : copies_) sum += each.bytes;
    return sum;
  }

  /// Returns the message with the figures of past ticks, of as many as a message holds and as are still
  /// known.
  std::string past(int from, int to) const {
    FrameWriter past;
    past.begin(Block::past);
    to = std::min(to, newest());
    from = empty() ? to + 1 : std::max({from, oldest(), to - max_ticks_per_message + 1});
    for (; from <= to; ++from) past.append(at(from).scalars);
    past.end();
    return past.take();
  }

  /// Brings drives nearer to the beginning of a stored tick: to the copy before it if that is nearer, else
  /// one tick further. `drives` may be empty at first. Returns whether they are as they were then, with the
  /// actions before it.
  bool approach(std::optional<Drives>& drives, int tick) const {
    if (drives && drives->ticks() == tick) return true;
    const auto later =
        std::find_if(copies_.begin(), copies_.end(), [&](const Copy& c) { return c.drives.ticks() > tick; });
    const Drives& copy = std::prev(later)->drives;
    if (!drives || drives->ticks() > tick || drives->ticks() < copy.ticks()) {
      drives = copy;
    } else {
      drives->tick(at(drives->ticks()).delays);
      act(*drives);
    }
    return drives->ticks() == tick;
  }
  /// Forgets what was driven after a tick (with -1, everything), and the actions after `ticks` ticks.
  void forget_after(int tick, int ticks) {
    for (; newest() > tick; ticks_.pop_back()) frame_bytes_ -= ticks_.back().bytes();
    if (newest() < oldest_) ticks_.clear();
    while (!copies_.empty() && copies_.back().drives.ticks() > tick) copies_.pop_back();
    std::erase_if(actions_, [&](const auto& each) { return each.first > ticks; });
  }
  /// Whether an action has not been shown yet: it came after the newest tick.
  bool is_action_due() const { return !actions_.empty() && actions_.back().first > newest(); }

 private:
  static constexpr int max_ticks_per_message = 800;
  static constexpr std::size_t max_copies = 128;  // a second apart, and before changes

  struct Copy {
    Drives drives;
    std::size_t bytes;
  };

  /// Forgets the copy, but for the oldest and the newest one, that is the least use for its age.
  void thin_out() {
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
  void forget_oldest() {
    DrivenTick& oldest = ticks_[static_cast<std::size_t>(oldest_++ - ticks_.front().tick)];
    frame_bytes_ -= oldest.bytes();
    oldest = {oldest.tick, oldest.delays, nullptr};
    if (copies_.size() < 2 || copies_[1].drives.ticks() > oldest_) return;
    copies_.pop_front();
    const int first = copies_.front().drives.ticks();
    while (ticks_.front().tick < first) ticks_.pop_front();
    std::erase_if(actions_, [&](const auto& each) { return each.first <= first; });
  }

  int most_ticks_, ticks_per_copy_;
  int oldest_ = 0;  ///< tick with the oldest frame
  Packing packing_;
  std::size_t frame_bytes_ = 0;
  std::deque<DrivenTick> ticks_;                 ///< from the first tick after the oldest copy on
  std::vector<std::pair<int, Action>> actions_;  ///< after how many ticks, in order
  std::deque<Copy> copies_;                      ///< by age
};

}  // namespace slalom::view
