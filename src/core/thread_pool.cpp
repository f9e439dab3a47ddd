#include "slalom/core/thread_pool.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "slalom/core/instruction_set.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom {

namespace {

using Clock = std::chrono::steady_clock;

void pause() noexcept {
#if SLALOM_X86
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Waits until `value` differs from `seen`: spins for about 50 microseconds, longer than guides of `svg_mppi`
/// keep one busy, then sleeps on a futex. A thread that sleeps starts 30 to 40 microseconds late.
std::uint32_t wait_for_change(const std::atomic<std::uint32_t>& value, std::uint32_t seen) noexcept {
  const auto until = Clock::now() + std::chrono::microseconds(50);
  for (;;) {
    for (int i = 0; i < 32; ++i) {
      const std::uint32_t now = value.load(std::memory_order_acquire);
      if (now != seen) return now;
      pause();
    }
    if (Clock::now() > until) break;
  }
  std::uint32_t now;
  while ((now = value.load(std::memory_order_acquire)) == seen) value.wait(seen, std::memory_order_acquire);
  return now;
}

}  // namespace

struct ThreadPool::Shared {
  /// The tasks of one thread that nobody has taken yet, in one word: the round in the upper half, so that a
  /// thread that wakes late cannot take a task of a round it has not seen, then the first one and the end,
  /// counted from the first task of the thread.
  class TaskRange {
   public:
    static constexpr std::uint32_t most = 0xffff;  ///< tasks

    void open(std::uint32_t of_round, std::uint32_t count) noexcept {
      word_.store(static_cast<std::uint64_t>(of_round) << 32 | count, std::memory_order_release);
    }
    /// Takes the first task if there is one in this round, as the thread itself does.
    bool take_first(std::uint32_t of_round, std::uint32_t& task) noexcept {
      std::uint64_t word = word_.load(std::memory_order_acquire);
      while (left(word, of_round) > 0) {
        task = begin(word);
        if (exchange(word, word + (1u << 16))) return true;
      }
      return false;
    }
    /// Takes the last task, as other threads do. To a thread that has begun they leave its last `few` ones.
    bool take_last(std::uint32_t of_round, std::uint32_t few, std::uint32_t& task) noexcept {
      std::uint64_t word = word_.load(std::memory_order_acquire);
      while (left(word, of_round) > (begin(word) > 0 ? few : 0)) {
        task = end(word) - 1;
        if (exchange(word, word - 1)) return true;
      }
      return false;
    }

   private:
    static std::uint32_t begin(std::uint64_t word) noexcept { return static_cast<std::uint32_t>(word) >> 16; }
    static std::uint32_t end(std::uint64_t word) noexcept { return static_cast<std::uint32_t>(word) & most; }
    static std::uint32_t left(std::uint64_t word, std::uint32_t of_round) noexcept {
      return word >> 32 == of_round ? end(word) - begin(word) : 0;
    }
    bool exchange(std::uint64_t& expected, std::uint64_t next) noexcept {
      return word_.compare_exchange_weak(expected, next, std::memory_order_acq_rel,
                                         std::memory_order_acquire);
    }

    alignas(64) std::atomic<std::uint64_t> word_{0};  // on a cache line of its own
  };

  explicit Shared(int threads) : ranges(static_cast<std::size_t>(threads)) {}

  alignas(64) std::atomic<std::uint32_t> round{0};
  alignas(64) std::atomic<std::uint32_t> unfinished{0};
  // The next four are released by the ranges, and kept until the last task taken from them has ended.
  Call call = nullptr;
  void* context = nullptr;
  std::uint32_t first = 0, tasks = 0;
  std::vector<TaskRange> ranges;  ///< range of each thread, the caller's first
  std::atomic<bool> busy{false};  ///< whether the workers serve a caller
  std::atomic<bool> quit{false};
  std::vector<std::thread> workers;

  /// The first task of a thread, or the end of those of the thread before it.
  std::uint32_t begin(std::size_t thread) const noexcept {
    return static_cast<std::uint32_t>(thread * tasks / ranges.size());
  }

  /// A thread takes its own tasks from the first one on, then those of others from their ends. So in each
  /// round of as many tasks it has the same ones but for a few, whose data are in its caches, and it rarely
  /// writes a cache line that another one reads.
  void work(std::uint32_t of_round, std::size_t self) noexcept {
    const auto start = Clock::now();
    std::uint32_t done = 0, task = 0;
    for (; ranges[self].take_first(of_round, task); ++done) run_task(self, task);
    // Taking tasks of two microseconds from a thread at work costs more: their data move twice.
    const double each = std::chrono::duration<double, std::micro>(Clock::now() - start).count() / done;
    const std::uint32_t few =
        done == 0 || each > 2 ? 0 : saturate_cast<std::uint32_t>(2 / std::max(each, 1e-3));
    for (std::size_t i = 1; i < ranges.size(); ++i) {
      const std::size_t owner = (self + i) % ranges.size();
      for (; ranges[owner].take_last(of_round, few, task); ++done) run_task(owner, task);
    }
    if (done > 0 && unfinished.fetch_sub(done, std::memory_order_acq_rel) == done) unfinished.notify_one();
  }

  void run_task(std::size_t owner, std::uint32_t task) noexcept {
    call(context, static_cast<int>(first + begin(owner) + task));
  }

  /// Runs the tasks `first_task` ... `first_task + count - 1`.
  void run(std::uint32_t first_task, std::uint32_t count) noexcept {
    const std::uint32_t next = round.load(std::memory_order_relaxed) + 1;
    first = first_task;
    tasks = count;
    unfinished.store(count, std::memory_order_relaxed);
    for (std::size_t i = 0; i < ranges.size(); ++i) ranges[i].open(next, begin(i + 1) - begin(i));
    round.store(next, std::memory_order_release);
    round.notify_all();
    work(next, 0);
    std::uint32_t left = unfinished.load(std::memory_order_acquire);
    while (left != 0) left = wait_for_change(unfinished, left);
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
  shared_ = std::make_unique<Shared>(threads);
  shared_->workers.reserve(threads - 1);
  const auto serve = [shared = shared_.get()](std::size_t self) {
    std::uint32_t seen = 0;
    for (;;) {
      seen = wait_for_change(shared->round, seen);
      if (shared->quit.load(std::memory_order_relaxed)) return;
      shared->work(seen, self);
    }
  };
  try {
    for (int i = 1; i < threads; ++i) shared_->workers.emplace_back(serve, static_cast<std::size_t>(i));
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
  if (!shared_ || count <= 1 || shared_->busy.exchange(true, std::memory_order_acquire)) {
    for (int i = 0; i < count; ++i) call(context, i);
    return;
  }
  shared_->call = call;
  shared_->context = context;
  for (int first = 0; first < count; first += static_cast<int>(Shared::TaskRange::most))
    shared_->run(static_cast<std::uint32_t>(first),
                 static_cast<std::uint32_t>(std::min<int>(count - first, Shared::TaskRange::most)));
  shared_->busy.store(false, std::memory_order_release);
}

}  // namespace slalom
