#pragma once

#include <memory>
#include <type_traits>

namespace slalom {

/// A fixed set of threads that works through numbered tasks. The caller works too: a pool of one has no other
/// thread, and running tasks on it takes no lock and makes no system call.
///
/// Any thread may run any task. Give each task its own slot for its partial result and combine them in order.
class ThreadPool {
 public:
  /// `threads` in [1, 1024], the caller's included. Throws std::invalid_argument otherwise, and
  /// std::runtime_error if the system cannot start that many.
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /// Number of threads that work on a call, the caller included.
  int threads() const noexcept { return threads_; }

  /// Calls `task(i)` for every i in [0, count) and returns when all have ended. Does not allocate; tasks must
  /// not throw. Workers wait 50 us before they sleep on a futex. While the workers serve one caller, another
  /// caller runs its tasks alone.
  template <class Task>
  void run(int count, Task&& task) noexcept {
    using Plain = std::remove_reference_t<Task>;
    run_erased(
        count, [](void* context, int i) { (*static_cast<Plain*>(context))(i); },
        const_cast<void*>(static_cast<const void*>(&task)));
  }

 private:
  using Call = void (*)(void* context, int i);
  void run_erased(int count, Call call, void* context) noexcept;

  struct Shared;
  int threads_;
  std::unique_ptr<Shared> shared_;
};

}  // namespace slalom
