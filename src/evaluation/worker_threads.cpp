#include "slalom/evaluation/worker_threads.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace slalom::evaluation {

int run_in_threads(int threads, const std::function<void()>& work) {
  std::vector<std::jthread> others;  // joined however this ends
  others.reserve(static_cast<std::size_t>(std::max(0, threads - 1)));
  try {
    while (static_cast<int>(others.size()) + 1 < threads) others.emplace_back([&] { work(); });
  } catch (const std::exception&) {
    // No thread or no memory. The work is shared, so those that run do all of it.
  }
  work();
  const int started = static_cast<int>(others.size()) + 1;
  others.clear();
  return started;
}

void for_each_in_threads(int threads, int count, const std::function<void(int)>& work,
                         const std::atomic<bool>* cancel) {
  std::atomic<int> next{0};
  std::mutex mutex;
  std::exception_ptr error;
  run_in_threads(std::min(threads, count), [&] {
    for (int i; !(cancel && cancel->load()) && (i = next++) < count;) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!error) error = std::current_exception();
        next = count;
      }
    }
  });
  if (error) std::rethrow_exception(error);
}

}  // namespace slalom::evaluation
