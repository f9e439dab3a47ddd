#include "slalom/evaluation/worker_threads.hpp"

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace slalom::evaluation {

void for_each_in_threads(int threads, int count, const std::function<void(int)>& work,
                         const std::atomic<bool>* cancel) {
  std::atomic<int> next{0};
  std::mutex mutex;
  std::exception_ptr error;
  const auto drain = [&] {
    for (int i; !(cancel && cancel->load()) && (i = next++) < count;) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!error) error = std::current_exception();
        next = count;
      }
    }
  };
  {
    std::vector<std::jthread> others;  // joined however this ends
    try {
      for (int i = 1; i < std::min(threads, count); ++i) others.emplace_back(drain);
    } catch (const std::exception&) {
      // No thread or no memory. The work is shared, so those that run do all of it.
    }
    drain();
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace slalom::evaluation
