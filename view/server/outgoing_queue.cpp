#include "view/server/outgoing_queue.hpp"

#include <utility>

namespace slalom::view {
namespace {

constexpr std::size_t max_messages = 256;
constexpr std::size_t max_bytes = 64 << 20;

}  // namespace

bool OutgoingQueue::push(const Message& message) {
  if (messages_.size() >= max_messages || bytes_ >= max_bytes) return false;
  bytes_ += message.body->size();
  messages_.push_back(message);
  return true;
}

bool OutgoingQueue::set_frame(const std::shared_ptr<const std::string>& frame) {
  return std::exchange(frame_, frame) != nullptr;
}

std::optional<OutgoingQueue::Item> OutgoingQueue::next(bool frame_may_go) {
  if (!messages_.empty()) {
    Item item{std::move(messages_.front()), false};
    messages_.pop_front();
    bytes_ -= item.message.body->size();
    return item;
  }
  if (!frame_ || !frame_may_go) return std::nullopt;
  return Item{{std::exchange(frame_, nullptr), true}, true};
}

void OutgoingQueue::clear() {
  messages_.clear();
  bytes_ = 0;
  frame_ = nullptr;
}

}  // namespace slalom::view
