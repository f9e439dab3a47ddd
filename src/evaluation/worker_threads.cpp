#include "slalom/evaluation/worker_threads.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>
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

}  // namespace slalom::evaluation
