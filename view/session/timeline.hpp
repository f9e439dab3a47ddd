#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "view/session/drives.hpp"

namespace slalom::view {

constexpr double stored_seconds = 60;  ///< s of a drive that can be shown again

/// The past of a drive: the frame of each tick, the actions of the user, and copies of the drives, from which
/// any stored tick is reached again exactly.
class Timeline {
 public:
  /// A tick that was driven.
  struct Step {
    int tick = 0;
    Delays delays;
    std::shared_ptr<const std::string> frame;  ///< message to the page
  };

  /// `control_period`: s per tick.
  explicit Timeline(double control_period = 1);

  /// Keeps a copy of the drives if the last one is a second old, or takes longer to be driven on to the
  /// present than a page should wait. To be called before each tick; `copy_bytes`: about the size of a copy,
  /// of which 1 GiB is kept at most; `tick_time`: s of wall clock that a tick takes.
  void checkpoint(const Drives& drives, std::size_t copy_bytes, double tick_time);
  /// Notes an action after `ticks` ticks, behind those that are noted there.
  void note(int ticks, Action action);
  /// Applies the actions that are noted for the ticks that drives have.
  void act(Drives& drives) const;
  /// Adds the tick that was driven last.
  void keep(Step step);

  bool empty() const noexcept { return steps_.empty(); }
  int oldest() const noexcept { return empty() ? -1 : steps_.front().tick; }
  int newest() const noexcept { return empty() ? -1 : steps_.back().tick; }
  const std::deque<Step>& steps() const noexcept { return steps_; }
  /// Returns a stored tick.
  const Step& at(int tick) const { return steps_.at(static_cast<std::size_t>(tick - oldest())); }

  /// Returns the drives as they were when a stored tick began, with the actions before it: a copy, driven on.
  Drives before(int tick) const;
  /// Returns the drives as they were right after a stored tick.
  Drives after(int tick) const;
  /// Forgets what was driven after a tick (with -1, everything), and the actions after `ticks` ticks.
  void forget_after(int tick, int ticks);
  /// Whether an action has not been shown yet: it came after the newest tick.
  bool is_action_due() const { return !actions_.empty() && actions_.back().first > newest(); }

 private:
  void thin_out();
  void forget_oldest();

  std::ptrdiff_t most_steps_;
  int ticks_per_copy_;
  std::size_t bytes_ = 0;                        ///< size of the frames
  std::deque<Step> steps_;                       ///< from the first tick after the oldest copy on
  std::vector<std::pair<int, Action>> actions_;  ///< after how many ticks, in order
  std::deque<Drives> copies_;                    ///< by age
};

}  // namespace slalom::view
