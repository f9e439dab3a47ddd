#pragma once

#include <deque>

#include "view/session/drives.hpp"

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

/// A tick that was driven.
struct DrivenTick {
  int tick = 0;
  std::array<StepRecord, 2> records{};         ///< facts about what is driven and the ghost
  std::shared_ptr<const Settings> settings{};  ///< method and options that drove
  std::shared_ptr<const std::string> frame{};  ///< message to the page, or what it is packed to
  Bounds bounds{};                             ///< around all that it draws
  std::string scalars{};                       ///< figures with which the message begins
  bool is_packed = false;

  /// Fills in `scalars`, which are the first `count` figures.
  void keep_scalars(std::size_t count);
  void pack(const Packing& packing);
  std::shared_ptr<const std::string> message(const Packing& packing) const;
  std::size_t bytes() const noexcept;  ///< size of the stored frame
};

/// The past of a drive: the frame of each tick, the actions of the user, and copies of the drives, from which
/// any stored tick is reached again exactly.
class Timeline {
 public:
  static constexpr std::size_t max_frame_bytes = 128u << 20;  ///< limit of all stored frames
  /// Limit of all copies, if there are more than three.
  static constexpr std::size_t max_copy_bytes = 64u << 20;

  /// `control_period`: s per tick.
  explicit Timeline(double control_period = 1, Packing packing = {});

  /// Keeps a copy of the drives if the last is a second of the drive's time old. To be called each tick.
  void checkpoint(const Drives& drives);
  /// Notes an action after `ticks` ticks, behind those that are noted there.
  void note(int ticks, Action action);
  /// Applies the actions that are noted for the ticks that drives have.
  void act(Drives& drives) const;
  /// Adds the tick that was driven last.
  void keep(DrivenTick tick);

  bool empty() const noexcept { return ticks_.empty(); }
  int oldest() const noexcept { return empty() ? -1 : oldest_; }
  int newest() const noexcept { return empty() ? -1 : ticks_.back().tick; }
  /// Returns a tick that was driven.
  const DrivenTick& at(int tick) const {
    return ticks_.at(static_cast<std::size_t>(tick - ticks_.front().tick));
  }
  /// Returns the message of a stored tick.
  std::shared_ptr<const std::string> frame(int tick) const { return at(tick).message(packing_); }
  std::vector<DrivenTick> stored() const;                            ///< ticks that are stored, by age
  std::size_t frame_bytes() const noexcept { return frame_bytes_; }  ///< bytes of the stored frames
  std::size_t copy_bytes() const noexcept;                           ///< bytes of all copies

  /// The message with the figures of past ticks, of as many as a message holds and as are still known.
  std::string past(int from, int to) const;

  /// Brings drives nearer to the beginning of a stored tick: to the copy before it if that is nearer, else
  /// one tick further. `drives` may be empty at first. Returns whether they are as they were then, with the
  /// actions before it.
  bool approach(std::optional<Drives>& drives, int tick) const;
  /// Forgets what was driven after a tick (with -1, everything), and the actions after `ticks` ticks.
  void forget_after(int tick, int ticks);
  /// Whether an action has not been shown yet: it came after the newest tick.
  bool is_action_due() const { return !actions_.empty() && actions_.back().first > newest(); }

 private:
  struct Copy {
    Drives drives;
    std::size_t bytes;
  };
  void thin_out();
  void forget_oldest();

  int most_ticks_, ticks_per_copy_;
  int oldest_ = 0;  ///< tick with the oldest frame
  Packing packing_;
  std::size_t frame_bytes_ = 0;
  std::deque<DrivenTick> ticks_;                 ///< from the first tick after the oldest copy on
  std::vector<std::pair<int, Action>> actions_;  ///< after how many ticks, in order
  std::deque<Copy> copies_;                      ///< by age
};

}  // namespace slalom::view
