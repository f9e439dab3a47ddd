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
      pool.run(count, [&](int i) { ++runs[i]; });
      for (int i = 0; i < 13; ++i) ASSERT_EQ(runs[i], i < count ? 1 : 0);
    }
  }
}

TEST(ThreadPool, RunsAnyNumberOfTasks) {
  ThreadPool pool(3);
  for (const int count : {65534, 65535, 65536, 200001}) {
    std::vector<int> runs(count);
    pool.run(count, [&](int i) { ++runs[i]; });
    for (const int each : runs) ASSERT_EQ(each, 1);
  }
}

TEST(ThreadPool, AThreadTakesTasksOfAnotherOneThatIsBusy) {
  ThreadPool pool(2);
  constexpr int count = 6;
  std::atomic<int> ended{0};
  pool.run(count, [&](int i) {
    if (i == 0) {  // the caller's first task ends after all others, two of which are the caller's too
      while (ended.load() < count - 1) std::this_thread::yield();
    } else {
      for (volatile int work = 0; work < 300000;) work = work + 1;  // long enough to be worth a move
    }
    ++ended;
  });
  EXPECT_EQ(ended.load(), count);
}

TEST(ThreadPool, ServesSeveralCallersAtOnce) {
  ThreadPool pool(3);
  std::vector<std::thread> callers;
  std::atomic<int> wrong{0};
  for (int caller = 0; caller < 4; ++caller)
    callers.emplace_back([&] {
      for (int round = 0; round < 500; ++round) {
        std::atomic<int> sum{0};
        pool.run(9, [&](int i) { pool.run(2, [&](int) { sum += i; }); });  // a task may call, too
        wrong += sum.load() != 72;
      }
    });
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(wrong.load(), 0);
}

TEST(ThreadPool, SleepingWorkersWake) {
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

/// Counts how often threads went to sleep in some rounds with a pause after each.
long sleeps(ThreadPool& pool, int rounds, std::chrono::microseconds pause) {
  const long before = voluntary_switches();
  for (int round = 0; round < rounds; ++round) {
    pool.run(4 * pool.threads(), [](int) {  // longer together than anyone spins
      const auto until = std::chrono::steady_clock::now() + std::chrono::microseconds(30);
      while (std::chrono::steady_clock::now() < until) {
      }
    });
    std::this_thread::sleep_for(pause);  // workers go to sleep
  }
  return voluntary_switches() - before;
}

TEST(ThreadPool, AThreadSleepsAtMostOnceARound) {
  constexpr int rounds = 50;
  ThreadPool pool(3);
  long most = 0;
  // On a busy machine a worker may have to wait for its turn before it can as much as go to sleep.
  for (int pause = 200; pause <= 51200 && most < 2 * rounds; pause *= 4) {
    most = sleeps(pool, rounds, std::chrono::microseconds(pause));
    EXPECT_LE(most, (pool.threads() + 1) * rounds);  // the caller sleeps once more, between the rounds
  }
  EXPECT_GE(most, 2 * rounds) << "nobody slept: nothing was measured";
}

TEST(ThreadPool, RejectsInvalidSizes) {
  EXPECT_THROW(ThreadPool(0), std::invalid_argument);
  EXPECT_THROW(ThreadPool(-3), std::invalid_argument);
}

}  // namespace
}  // namespace slalom
