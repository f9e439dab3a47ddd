#pragma once

#include "sim/lidar/scan.hpp"
#include "slalom/core/math.hpp"

/// Noise of a scan, one beam per lane. No product is fused with a sum: all instruction sets give the same
/// bits.
namespace slalom::sim::detail {

/// A hash of 32 bits; `U` is a vector of unsigned integers.
template <class U>
SLALOM_INLINE U hash(const U& value) {
  U x = (value ^ value >> 16) * 0x7feb352du;
  x = (x ^ x >> 15) * 0x846ca68bu;
  return x ^ x >> 16;
}

/// ln(x) for x in (0, 1]: the polynomial of S. L. Moshier's Cephes library (logf).
template <class F>
SLALOM_INLINE F log_of_fraction(const F& x) {
  using I = typename simd::IntPack<typename F::Target>::Vector;
  using V = typename F::Vector;
  const I bits = reinterpret_cast<I>(x.v);
  const I e = (bits - 0x3f3504f3) >> 23;
  const F m = F(reinterpret_cast<V>(bits - (e << 23))) - F(1.0f);
  const F n = to_float(simd::IntPack<typename F::Target>(e));
  const F m2 = m * m;
  F p = F(7.0376836292e-2f);
  p = p * m - F(1.1514610310e-1f);
  p = p * m + F(1.1676998740e-1f);
  p = p * m - F(1.2420140846e-1f);
  p = p * m + F(1.4249322787e-1f);
  p = p * m - F(1.6668057665e-1f);
  p = p * m + F(2.0000714765e-1f);
  p = p * m - F(2.4999993993e-1f);
  p = p * m + F(3.3333331174e-1f);
  return m + (m * m2 * p - n * F(2.12194440e-4f) - F(0.5f) * m2) + n * F(0.693359375f);
}

/// Sine and cosine of an angle that is counted in 2^-32 turns. Cephes' polynomials on an eighth of a turn.
template <class F>
SLALOM_INLINE void sin_cos_of_turn(const typename simd::detail::VectorTypes<F::lanes>::Unsigned& turn,
                                   F& sine, F& cosine) {
  using U = typename simd::detail::VectorTypes<F::lanes>::Unsigned;
  using I = simd::IntPack<typename F::Target>;
  using V = typename F::Vector;
  const U quarter = (turn + 0x20000000u) >> 30;
  const I rest(reinterpret_cast<typename I::Vector>(turn - (quarter << 30)));
  const F r = to_float(rest) * F(static_cast<float>(6.283185307179586 * 0x1p-32));
  const F r2 = r * r;
  const F s = r + r * r2 * (F(-1.6666654611e-1f) + r2 * (F(8.3321608736e-3f) - r2 * F(1.9515295891e-4f)));
  const F c = (F(1.0f) - F(0.5f) * r2) +
              r2 * r2 * (F(4.166664568e-2f) + r2 * (F(-1.388731625e-3f) + r2 * F(2.443315712e-5f)));
  const auto odd = I(reinterpret_cast<typename I::Vector>(quarter & 1)) == I(1);
  const F a = select(odd, c, s), b = select(odd, s, c);
  sine = F(reinterpret_cast<V>(reinterpret_cast<U>(a.v) ^ (quarter >> 1 << 31)));
  cosine = F(reinterpret_cast<V>(reinterpret_cast<U>(b.v) ^ ((quarter + 1) >> 1 << 31)));
}

/// The kernel that adds noise to the ranges of a scan and drops beams.
struct AddRangeNoise {
  template <class Target>
  SLALOM_KERNEL static void run(const NoiseTask& task) {
    using F = Pack<simd::Unfused<Target>>;
    using I = simd::IntPack<simd::Unfused<Target>>;
    using U = typename simd::detail::VectorTypes<F::lanes>::Unsigned;
    constexpr std::uint32_t sign = 0x80000000u;  // added to compare as unsigned numbers
    const F zero(0.0f), most(task.most);
    const I lost_below(static_cast<int>(task.lost_below ^ sign));
    U lane{};
    for (int i = 0; i < F::lanes; ++i) lane[i] = static_cast<std::uint32_t>(i);
    // One draw of two normal values serves a beam and the one 16 further on, for packs of any width.
    for (int first = 0; first < task.count; first += 32)
      for (int part = 0; part < 16; part += F::lanes) {
        const int at = first + part;
        const U a = hash(U(hash(U((lane + static_cast<std::uint32_t>(at)) ^ task.key0)) ^ task.key1));
        const U b = hash(U(a ^ task.key0 ^ 0x9e3779b9u));
        // 24 bits and a half, so that it is never 0.
        const F uniform = to_float(I(reinterpret_cast<typename I::Vector>(a >> 8)));
        F sine, cosine;
        sin_cos_of_turn(b, sine, cosine);
        const F radius =
            sqrt(log_of_fraction((uniform + F(0.5f)) * F(0x1p-24f)) * F(-2.0f)) * F(task.deviation);
        for (int half = 0; half < 2; ++half) {
          float* const to = task.ranges + at + 16 * half;
          const F range = F::load(to);
          F noisy = min(max(range + radius * (half ? sine : cosine), zero), most);
          if (task.lost_below > 0) {
            const U draw = hash(U(b ^ task.key1 ^ (half ? 0x85ebca6bu : 0xc2b2ae35u)));
            const I drawn(reinterpret_cast<typename I::Vector>(draw ^ sign));
            noisy = select(drawn < lost_below, most, noisy);
          }
          select(range >= most, range, noisy).store(to);
        }
      }
  }
};

}  // namespace slalom::sim::detail
