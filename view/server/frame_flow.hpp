#pragma once

#include <cstdint>

namespace slalom::view {

/// Decides when the next frame is sent to a client, from the frames that it has acknowledged. So a slow
/// client shows the newest frame with the delay of two frames, and not that of a full socket buffer.
///
/// The control starts with the first acknowledgement, usually of 0 frames. A client that never acknowledges
/// gets frames as fast as its socket takes them.
class FrameFlow {
 public:
  static constexpr std::uint32_t most_in_flight = 2;  ///< frames sent and not yet acknowledged

  bool may_send() const noexcept { return !is_controlled_ || sent_ - acknowledged_ < most_in_flight; }
  void count_sent() noexcept { ++sent_; }

  /// `frames`: how many the client has shown since it connected. False if that is impossible or not new.
  bool acknowledge(std::uint32_t frames) noexcept {
    if (frames > sent_ || frames < acknowledged_ || (is_controlled_ && frames == acknowledged_)) return false;
    is_controlled_ = true;
    acknowledged_ = frames;
    return true;
  }

 private:
  std::uint32_t sent_ = 0, acknowledged_ = 0;
  bool is_controlled_ = false;
};

}  // namespace slalom::view
