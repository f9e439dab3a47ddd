#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "view/server/server.hpp"

namespace slalom::view {

/// The queue to one client: messages in order, and after them the newest frame.
class OutgoingQueue {
 public:
  struct Item {
    Message message;
    bool is_frame = false;
  };

  /// False if 256 messages or 64 MiB are already waiting. A single message may be larger: the recording of a
  /// minute has 70 MB.
  bool push(const Message& message);
  /// Sets the frame to be sent. True if an unsent frame was replaced.
  bool set_frame(const std::shared_ptr<const std::string>& frame);
  /// Removes and returns what is to be sent next: a message, or the frame if there is none and
  /// `frame_may_go`.
  std::optional<Item> next(bool frame_may_go);
  void clear();

 private:
  std::deque<Message> messages_;
  std::size_t bytes_ = 0;  ///< size of the messages
  std::shared_ptr<const std::string> frame_;
};

}  // namespace slalom::view
