#include "support/thread_starts.hpp"

#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>

namespace slalom::testing {
namespace {

constexpr int any_number = 1 << 20;

/// Threads that can still be started. A local variable, since other libraries may start one before the
/// variables of this file are there.
std::atomic<int>& allowed() {
  static std::atomic<int> count{any_number};
  return count;
}

}  // namespace

FewThreads::FewThreads(int count) noexcept {
  allowed() = count;
}
FewThreads::~FewThreads() {
  allowed() = any_number;
}

}  // namespace slalom::testing

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                              void* argument) {
  if (slalom::testing::allowed().fetch_sub(1) <= 0) return EAGAIN;
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
  return create(thread, attributes, start, argument);
}
