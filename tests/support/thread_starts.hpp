#pragma once

namespace slalom::testing {

/// While it exists, the system starts only `count` more threads; pthread_create then fails with EAGAIN. A
/// test program that uses it links `slalom_test_thread_starts`, which replaces pthread_create.
class FewThreads {
 public:
  explicit FewThreads(int count) noexcept;
  ~FewThreads();
  FewThreads(const FewThreads&) = delete;
  FewThreads& operator=(const FewThreads&) = delete;
};

}  // namespace slalom::testing
