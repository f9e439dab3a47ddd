#include "slalom/core/thread_pool.hpp"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "slalom/core/instruction_set.hpp"

namespace slalom {

namespace {

void pause() noexcept {
#if SLALOM_X86
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Waits until `value` differs from `seen`: spins for about 20 microseconds, then sleeps on a futex.
std::uint32_t wait_for_change(const std::atomic<std::uint32_t>& value, std::uint32_t seen) noexcept {
  const auto until = std::chrono::steady_clock::now() + std::chrono::microseconds(20);
  for (;;) {
    for (int i = 0; i < 32; ++i) {
      const std::uint32_t now = value.load(std::memory_order_acquire);
      if (now != seen) return now;
      pause();
    }
    if (std::chrono::steady_clock::now() > until) break;
  }
  std::uint32_t now;
  while ((now = value.load(std::memory_order_acquire)) == seen) value.wait(seen, std::memory_order_acquire);
  return now;
}

}  // namespace

struct ThreadPool::Shared {
  alignas(64) std::atomic<std::uint32_t> round{0};
  /// The round in the upper half, how many of its tasks are not yet taken in the lower: so a worker that
  /// wakes late cannot take a task of a round it has not seen.
  alignas(64) std::atomic<std::uint64_t> open{0};
  alignas(64) std::atomic<std::uint32_t> unfinished{0};
  Call call =
      nullptr;  // these three are released by `open`, and kept until the last task taken from it has ended
  void* context = nullptr;
  std::uint32_t tasks = 0;
  std::atomic<bool> quit{false};
  std::vector<std::thread> workers;

  void work(std::uint32_t of_round) noexcept {
    std::uint64_t ticket = open.load(std::memory_order_acquire);
    while ((ticket >> 32) == of_round && static_cast<std::uint32_t>(ticket) != 0) {
      if (!open.compare_exchange_weak(ticket, ticket - 1, std::memory_order_acq_rel,
                                      std::memory_order_acquire))
        continue;
      // The first task begins first: callers put the longest there.
      call(context, static_cast<int>(tasks - static_cast<std::uint32_t>(ticket)));
      if (unfinished.fetch_sub(1, std::memory_order_acq_rel) == 1) unfinished.notify_one();
      ticket = open.load(std::memory_order_acquire);
    }
  }

  /// Ends the workers.
  void stop() {
    quit.store(true, std::memory_order_relaxed);
    round.fetch_add(1, std::memory_order_release);
    round.notify_all();
    for (auto& worker : workers) worker.join();
  }
};

ThreadPool::ThreadPool(int threads) : threads_(threads) {
  if (threads < 1 || threads > 1024) {
    throw std::invalid_argument("threads: " + std::to_string(threads) + " must be in [1, 1024]");
  }
  if (threads == 1) return;
  shared_ = std::make_unique<Shared>();
  shared_->workers.reserve(static_cast<std::size_t>(threads - 1));
  const auto serve = [shared = shared_.get()] {
    std::uint32_t seen = 0;
    for (;;) {
      seen = wait_for_change(shared->round, seen);
      if (shared->quit.load(std::memory_order_relaxed)) return;
      shared->work(seen);
    }
  };
  try {
    for (int i = 1; i < threads; ++i) shared_->workers.emplace_back(serve);
  } catch (const std::system_error& error) {
    const std::size_t started = shared_->workers.size() + 1;
    shared_->stop();
    throw std::runtime_error("threads: " + std::to_string(threads) + " cannot start, " +
                             std::to_string(started) + " can (" + error.code().message() +
                             "); use fewer threads, or raise the limits of processes and memory");
  } catch (...) {
    shared_->stop();
    throw;
  }
}

ThreadPool::~ThreadPool() {
  if (shared_) shared_->stop();
}

void ThreadPool::run_erased(int count, Call call, void* context) noexcept {
  if (!shared_ || count <= 1) {
    for (int i = 0; i < count; ++i) call(context, i);
    return;
  }
  Shared& s = *shared_;
  const std::uint32_t tasks = static_cast<std::uint32_t>(count),
                      round = s.round.load(std::memory_order_relaxed) + 1;
  s.call = call;
  s.context = context;
  s.tasks = tasks;
  s.unfinished.store(tasks, std::memory_order_relaxed);
  s.open.store(static_cast<std::uint64_t>(round) << 32 | tasks, std::memory_order_release);
  s.round.store(round, std::memory_order_release);
  s.round.notify_all();
  s.work(round);
  std::uint32_t left = s.unfinished.load(std::memory_order_acquire);
  while (left != 0) left = wait_for_change(s.unfinished, left);
}

}  // namespace slalom
