// Evaluations go on when the system cannot start a thread.
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "slalom/core/thread_pool.hpp"
#include "slalom/evaluation/worker_threads.hpp"
#include "support/thread_starts.hpp"

namespace slalom {
namespace {

using testing::FewThreads;

TEST(ThreadStart, APoolThatCannotStartAllItsThreadsSaysHowManyItCould) {
  for (int possible = 0; possible < 5; ++possible) {
    const FewThreads few(possible);
    try {
      ThreadPool pool(6);
      FAIL() << possible;
    } catch (const std::runtime_error& error) {
      const std::string said = error.what();
      EXPECT_NE(said.find("threads: 6 cannot start, " + std::to_string(possible + 1) + " can"),
                std::string::npos)
          << said;
    }
  }
  const FewThreads enough(5);
  ThreadPool pool(6);
  std::atomic<int> calls{0};
  pool.run(100, [&](int) { ++calls; });
  EXPECT_EQ(calls, 100);
}

TEST(ThreadStart, SharedWorkIsDoneByTheThreadsThatRun) {
  for (int possible = 0; possible < 4; ++possible) {
    const FewThreads few(possible);
    std::atomic<int> done{0};
    evaluation::for_each_in_threads(4, 1000, [&](int) { ++done; });
    EXPECT_EQ(done, 1000);
  }
}

}  // namespace
}  // namespace slalom
