#include "slalom/evaluation/worker_threads.hpp"

#include <algorithm>
#include <cstddef>
#include <system_error>
#include <thread>
#include <vector>

namespace slalom::evaluation {

int run_in_threads(int threads, const std::function<void()>& work) {
  std::vector<std::thread> others;
  others.reserve(static_cast<std::size_t>(std::max(0, threads - 1)));
  try {
    while (static_cast<int>(others.size()) + 1 < threads) others.emplace_back([&] { work(); });
  } catch (const std::system_error&) {
    // The work is shared, so those that run do all of it.
  }
  work();
  for (std::thread& thread : others) thread.join();
  return static_cast<int>(others.size()) + 1;
}

}  // namespace slalom::evaluation
