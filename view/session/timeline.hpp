#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slalom/solvers/solver.hpp"
#include "view/protocol/frame_writer.hpp"

namespace slalom::view {

constexpr double stored_seconds = 60;  ///< s of a drive that can be shown again

inline std::shared_ptr<const std::string> shared(std::string text) {
  return std::make_shared<const std::string>(std::move(text));
}

/// Estimates the bytes of a copy of a controller: the batch of samples, and other arrays of that order.
inline std::size_t bytes_of(const SolveResult* solve) {
  if (!solve || !solve->samples) return 0;
  const SequenceBatch& batch = *solve->samples;
  return std::size_t{8} * sizeof(float) * static_cast<std::size_t>(batch.samples()) *
         static_cast<std::size_t>(batch.steps()) * static_cast<std::size_t>(batch.inputs());
}

/// Delays by which commands take effect later than the settings say, s.
struct Delays {
  double car = 0, ghost = 0;
};

/// The past of a drive: the frame of each tick, the actions of the user, and copies of the drives, from which
/// any stored tick is reached again exactly. `Drives` can be copied, and has `int ticks() const` and
/// `void tick(const Delays&)`, which drives one more.
template <class Drives>
class TimelineOf {
 public:
  /// An action of a user between two ticks.
  using Action = std::function<void(Drives&)>;
  /// A tick that was driven.
  struct Step {
    int tick = 0;
    Delays delays;
    std::shared_ptr<const std::string> frame;  ///< message to the page
  };

  /// `control_period`: s per tick.
  explicit TimelineOf(double control_period = 1)
      : most_steps_(static_cast<std::ptrdiff_t>(stored_seconds / control_period)),
        ticks_per_copy_(std::max(1, static_cast<int>(std::lround(1 / control_period)))) {}

  /// Keeps a copy of the drives if the last one is a second old, or takes longer to be driven on to the
  /// present than a page should wait. To be called before each tick; `copy_bytes`: about the size of a copy,
  /// of which 1 GiB is kept at most; `tick_time`: s of wall clock that a tick takes.
  void checkpoint(const Drives& drives, std::size_t copy_bytes, double tick_time) {
    const double way = copies_.empty() ? 0 : drives.ticks() - copies_.back().ticks();
    if (!copies_.empty() && way < ticks_per_copy_ && way * tick_time < longest_way) return;
    copies_.push_back(drives);
    const std::size_t most = max_copy_bytes / std::max<std::size_t>(1, copy_bytes);
    while (copies_.size() > std::clamp(most, std::size_t{4}, max_copies)) thin_out();
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
  void keep(Step step) {
    bytes_ += step.frame->size();
    steps_.push_back(std::move(step));
    const auto is_surplus = [&] {
      return bytes_ > max_frame_bytes || newest() - copies_[1].ticks() >= most_steps_;
    };
    while (copies_.size() > 1 && is_surplus()) forget_oldest();
  }

  bool empty() const noexcept { return steps_.empty(); }
  int oldest() const noexcept { return empty() ? -1 : steps_.front().tick; }
  int newest() const noexcept { return empty() ? -1 : steps_.back().tick; }
  const std::deque<Step>& steps() const noexcept { return steps_; }
  /// Returns a stored tick.
  const Step& at(int tick) const { return steps_.at(static_cast<std::size_t>(tick - oldest())); }

  /// Returns the message with the first `scalars` values of the frames of past ticks, of as many as a message
  /// holds and as are still known.
  std::string past(int from, int to, std::size_t scalars) const {
    FrameWriter past;
    past.begin(Block::past);
    to = std::min(to, newest());
    from = empty() ? to + 1 : std::max({from, oldest(), to - max_ticks_per_message + 1});
    for (; from <= to; ++from)
      past.append(std::string_view(*at(from).frame).substr(FrameWriter::head_bytes, 8 * scalars));
    past.end();
    return past.take();
  }

  /// Returns the drives as they were when a stored tick began, with the actions before it: a copy, driven on.
  Drives before(int tick) const {
    const auto later =
        std::find_if(copies_.begin(), copies_.end(), [&](const Drives& each) { return each.ticks() > tick; });
    Drives drives = *std::prev(later);
    for (; drives.ticks() < tick; act(drives)) drives.tick(at(drives.ticks()).delays);
    return drives;
  }
  /// Forgets what was driven after a tick (with -1, everything), and the actions after `ticks` ticks.
  void forget_after(int tick, int ticks) {
    for (; newest() > tick; steps_.pop_back()) bytes_ -= steps_.back().frame->size();
    while (!copies_.empty() && copies_.back().ticks() > tick) copies_.pop_back();
    std::erase_if(actions_, [&](const auto& each) { return each.first > ticks; });
  }
  /// Whether an action has not been shown yet: it came after the newest tick.
  bool is_action_due() const { return !actions_.empty() && actions_.back().first > newest(); }

 private:
  static constexpr int max_ticks_per_message = 800;
  static constexpr std::size_t max_frame_bytes = 400u << 20;
  static constexpr std::size_t max_copy_bytes = 1u << 30;
  static constexpr std::size_t max_copies = 200;
  static constexpr double longest_way = 0.01;  // s of planning from a copy to the tick that is sought

  /// Forgets the copy among the older half whose neighbours are nearest to each other.
  void thin_out() {
    std::size_t least = 1;
    const auto gap = [&](std::size_t i) { return copies_[i + 1].ticks() - copies_[i - 1].ticks(); };
    for (std::size_t i = 2; i < copies_.size() / 2; ++i)
      if (gap(i) < gap(least)) least = i;
    copies_.erase(copies_.begin() + static_cast<std::ptrdiff_t>(least));
  }
  /// Forgets the oldest copy and the ticks up to the next one.
  void forget_oldest() {
    copies_.pop_front();
    const int first = copies_.front().ticks();
    for (; !empty() && oldest() < first; steps_.pop_front()) bytes_ -= steps_.front().frame->size();
    std::erase_if(actions_, [&](const auto& each) { return each.first <= first; });
  }

  std::ptrdiff_t most_steps_;
  int ticks_per_copy_;
  std::size_t bytes_ = 0;                        ///< size of the frames
  std::deque<Step> steps_;                       ///< from the first tick after the oldest copy on
  std::vector<std::pair<int, Action>> actions_;  ///< after how many ticks, in order
  std::deque<Drives> copies_;                    ///< by age
};

}  // namespace slalom::view
