#include "bench/workload/peak.hpp"

#include <algorithm>
#include <chrono>

#include "slalom/core/dispatch.hpp"
#include "slalom/core/math.hpp"

namespace slalom::workload {

namespace {

constexpr int chains = 10, rounds = 4000;

/// Runs `rounds` rounds of a product and a sum on every chain and returns a value that depends on all.
struct Chains {
  template <class Target>
  SLALOM_KERNEL static float run() {
    using F = Pack<Target>;
    const F factor(0.999f), addend(0.001f);
    F a0(1.0f), a1(1.1f), a2(1.2f), a3(1.3f), a4(1.4f), a5(1.5f), a6(1.6f), a7(1.7f), a8(1.8f), a9(1.9f);
    for (int i = 0; i < rounds; ++i) {
      a0 = a0 * factor + addend;
      a1 = a1 * factor + addend;
      a2 = a2 * factor + addend;
      a3 = a3 * factor + addend;
      a4 = a4 * factor + addend;
      a5 = a5 * factor + addend;
      a6 = a6 * factor + addend;
      a7 = a7 * factor + addend;
      a8 = a8 * factor + addend;
      a9 = a9 * factor + addend;
    }
    const F sum = ((a0 + a1) + (a2 + a3)) + ((a4 + a5) + (a6 + a7)) + (a8 + a9);
    return sum.v[0];
  }
};

struct Lanes {
  template <class Target>
  SLALOM_KERNEL static int run() {
    return Target::lanes;
  }
};

}  // namespace

double measured_peak_gflops(simd::Target target) {
  const auto run = simd::kernel<Chains>(target);
  const int lanes = simd::kernel<Lanes>(target)();
  double least = 1e30;
  volatile float sink = 0;
  for (int i = 0; i < 300; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    sink = run();
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  static_cast<void>(sink);
  return 2e-9 * chains * rounds * lanes / least;
}

}  // namespace slalom::workload
