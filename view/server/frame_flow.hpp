#pragma once

#include <cstdint>

namespace slalom::view {

/// Decides when the next frame is sent to a client, from the frames that it has acknowledged. So a slow
/// client shows a recent frame, with the delay of two frames and not that of a full socket buffer.
class FrameFlow {
 public:
  static constexpr std::uint32_t max_in_flight = 2;  ///< frames sent and not yet acknowledged

  /// `is_controlled`: the client acknowledges frames; otherwise it gets them as fast as its socket takes
  /// them.
  explicit FrameFlow(bool is_controlled) noexcept : is_controlled_(is_controlled) {}

  bool may_send() const noexcept { return !is_controlled_ || sent_ - acknowledged_ < max_in_flight; }
  void count_sent() noexcept { ++sent_; }

  /// `frames`: how many the client has shown since it connected. False if that is impossible or not new.
  bool acknowledge(std::uint32_t frames) noexcept {
    if (!is_controlled_ || frames > sent_ || frames <= acknowledged_) return false;
    acknowledged_ = frames;
    return true;
  }

 private:
  bool is_controlled_;
  std::uint32_t sent_ = 0, acknowledged_ = 0;
};

}  // namespace slalom::view
