// What happens when the system cannot start a thread: `pthread_create` is replaced by one that fails on
// demand.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <stdexcept>
#include <string>

#include "slalom/core/thread_pool.hpp"
#include "slalom/evaluation/worker_threads.hpp"

namespace {

std::atomic<int> allowed{1 << 20};  // threads that can still be started

}  // namespace

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                              void* argument) {
  if (allowed.fetch_sub(1) <= 0) return EAGAIN;
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
  return create(thread, attributes, start, argument);
}

namespace slalom {
namespace {

class ThreadStart : public ::testing::Test {
 protected:
  ~ThreadStart() override { allowed = 1 << 20; }
};

TEST_F(ThreadStart, APoolThatCannotStartAllItsThreadsSaysHowManyItCould) {
  for (int possible = 0; possible < 5; ++possible) {
    allowed = possible;
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
  allowed = 5;
  ThreadPool pool(6);
  std::atomic<int> calls{0};
  pool.run(100, [&](int) { ++calls; });
  EXPECT_EQ(calls, 100);
}

TEST_F(ThreadStart, SharedWorkIsDoneByTheThreadsThatRun) {
  for (int possible = 0; possible < 4; ++possible) {
    allowed = possible;
    std::atomic<int> next{0}, done{0};
    const int threads = evaluation::run_in_threads(4, [&] {
      while (next.fetch_add(1) < 1000) ++done;
    });
    EXPECT_EQ(threads, possible + 1);
    EXPECT_EQ(done, 1000);
  }
}

}  // namespace
}  // namespace slalom
