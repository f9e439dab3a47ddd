#pragma once

#include <sys/resource.h>

#include <ctime>
#include <stdexcept>
#include <string>

extern "C" [[gnu::weak]] void __asan_init();
extern "C" [[gnu::weak]] void __tsan_init();

namespace slalom::testing {

/// A promise was broken.
struct Finding : std::logic_error {
  using std::logic_error::logic_error;
};

/// A call took longer than it may.
struct SlowCall : Finding {
  using Finding::Finding;
};

/// The result of `call`. Other programs slow down a shared machine, so that a slow call is repeated, and is a
/// finding only if it is slow three times.
template <class Call>
auto repeat_if_slow(const Call& call) {
  for (int attempt = 1;; ++attempt) {
    try {
      return call();
    } catch (const SlowCall&) {
      if (attempt == 3) throw;
    }
  }
}

/// Throws Finding unless `holds`: for properties that tests and fuzz targets share.
inline void require(bool holds, const std::string& promise) {
  if (!holds) throw Finding(promise);
}

/// The time and memory that a call takes beyond what docs/robustness.md says for its size: 0.1 s of processor
/// time of its thread, and 200 MB; more under sanitizers.
class CallLimits {
 public:
  /// Throws SlowCall or Finding where the calls since construction, one if not said, took more.
  void check(int calls = 1) const {
    if (seconds() - before_ > 0.1 * slowness() * calls) throw SlowCall("a call takes at most 0.1 s");
    require(megabytes() - held_ <= 200 * (slowness() > 1 ? 3 : 1) * calls, "a call takes at most 200 MB");
  }

 private:
  /// Kernels are compiled without the sanitizers of their program, so that no macro tells.
  static int slowness() noexcept { return __asan_init != nullptr || __tsan_init != nullptr ? 20 : 1; }
  static double seconds() noexcept {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }
  static double megabytes() noexcept {  // the most that the process has held so far
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
  }
  double before_ = seconds(), held_ = megabytes();
};

}  // namespace slalom::testing
