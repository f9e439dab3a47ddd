#include "view/server/inbox.hpp"

#include <utility>

namespace slalom::view {
namespace {

constexpr std::size_t max_received = 1024;

}  // namespace

void Inbox::deliver(Received received) {
  const bool is_message = received.kind == Received::Kind::message;
  {
    const std::lock_guard lock(mutex_);
    if (is_message && received_.size() >= max_received) {
      ++counters_.refused_rate;
      return;
    }
    received_.push_back(std::move(received));
  }
  if (is_message) ++counters_.messages;
  arrived_.notify_all();
}

std::vector<Received> Inbox::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(received_, {});
}

void Inbox::wait(std::chrono::nanoseconds at_most) {
  std::unique_lock lock(mutex_);
  arrived_.wait_for(lock, at_most, [this] { return !received_.empty(); });
}

}  // namespace slalom::view
