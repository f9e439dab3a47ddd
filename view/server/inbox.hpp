#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <vector>

#include "view/server/counters.hpp"
#include "view/server/server.hpp"

namespace slalom::view {

/// Messages and events from clients, kept until `Server::take` fetches them. Safe to use from several
/// threads.
class Inbox {
 public:
  /// Counts in `counters` which messages it keeps and which it drops.
  explicit Inbox(AtomicCounters& counters) : counters_(counters) {}

  /// Keeps at most 1024 messages and drops those beyond; events are always kept.
  void deliver(Received received);
  std::vector<Received> take();
  /// Waits until something is there, for `at_most` at most.
  void wait(std::chrono::nanoseconds at_most);

 private:
  AtomicCounters& counters_;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<Received> received_;
};

}  // namespace slalom::view
