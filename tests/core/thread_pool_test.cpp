#include "slalom/core/thread_pool.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace slalom {
namespace {

TEST(ThreadPool, RunsEveryTaskOnceEachTime) {
  for (const int threads : {1, 2, 7}) {
    ThreadPool pool(threads);
    for (int round = 0; round < 2000; ++round) {
      const int count = round % 13;
      std::vector<std::atomic<int>> runs(13);
      pool.run(count, [&](int i) { ++runs[static_cast<std::size_t>(i)]; });
      for (int i = 0; i < 13; ++i) ASSERT_EQ(runs[static_cast<std::size_t>(i)], i < count ? 1 : 0);
    }
  }
}

TEST(ThreadPool, WorkersThatHaveGoneToSleepWakeAgain) {
  ThreadPool pool(3);
  for (int round = 0; round < 20; ++round) {
    std::atomic<int> sum{0};
    pool.run(8, [&](int i) { sum += i; });
    ASSERT_EQ(sum, 28);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

long voluntary_switches() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_nvcsw;
}

TEST(ThreadPool, AThreadSleepsAtMostOnceARound) {
  constexpr int threads = 3, rounds = 200;
  ThreadPool pool(threads);
  const long before = voluntary_switches();
  for (int round = 0; round < rounds; ++round) {
    pool.run(4 * threads, [](int) {  // longer together than anyone spins
      const auto until = std::chrono::steady_clock::now() + std::chrono::microseconds(30);
      while (std::chrono::steady_clock::now() < until) {
      }
    });
    std::this_thread::sleep_for(std::chrono::microseconds(200));  // workers go to sleep
  }
  const long switches = voluntary_switches() - before;
  EXPECT_GE(switches, 2 * rounds) << "nobody slept: nothing was measured";
  EXPECT_LE(switches, (threads + 1) * rounds);  // the caller sleeps once more, between the rounds
}

TEST(ThreadPool, RefusesAbsurdSizes) {
  EXPECT_THROW(ThreadPool(0), std::invalid_argument);
  EXPECT_THROW(ThreadPool(-3), std::invalid_argument);
}

}  // namespace
}  // namespace slalom
