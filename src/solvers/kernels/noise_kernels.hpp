#pragma once

#include "solvers/kernels/kernels.hpp"
#include "solvers/kernels/lanes.hpp"

/// Kernels that shape noise: see noise_shape.hpp.
namespace slalom::detail::kernel {

/// `Colour` for `packs` packs that begin at sample k. They share each loaded entry of L.
template <int packs, class F>
SLALOM_INLINE void colour_packs(const Rows<RealOf<F>>& z, const RealOf<F>* factor, int first, int step,
                                int k) {
  using L = Lanes<F>;
  const int steps = (z.rows - first + step - 1) / step;
  for (int t = steps - 1; t >= 0; --t) {
    const RealOf<F>* row = factor + static_cast<std::ptrdiff_t>(t) * (t + 1) / 2;
    F sum[packs];
    for (int b = 0; b < packs; ++b) sum[b] = F(0.0f);
    for (int s = 0; s <= t; ++s) {
      const F entry(row[s]);
      const RealOf<F>* from = z.row(first + s * step) + k;
      for (int b = 0; b < packs; ++b) sum[b] = sum[b] + entry * L::load(from + b * L::count);
    }
    for (int b = 0; b < packs; ++b) L::store(sum[b], z.row(first + t * step) + k + b * L::count);
  }
}

/// z <- L z over the rows first, first + step, ... of one input, from the last row to the first, in place.
struct Colour {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows<RealIn<Target>>& z, const RealIn<Target>* factor, int first,
                                int step, Range range) {
    using F = PackIn<Target>;
    constexpr int lanes = Lanes<F>::count;
    const int end = range.first + range.count;
    int k = range.first;
    for (; k + 4 * lanes <= end; k += 4 * lanes) colour_packs<4, F>(z, factor, first, step, k);
    for (; k < end; k += lanes) colour_packs<1, F>(z, factor, first, step, k);
  }
};

/// z <- z exp(s y - s^2). `y` has the layout of z; `spread` [row] is s.
struct SpreadLogNormal {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows<RealIn<Target>>& z, const RealIn<Target>* y,
                                const RealIn<Target>* spread, Range range) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    using Real = RealIn<Target>;
    for (int r = 0; r < z.rows; ++r) {
      const F s(spread[r]), shift(-spread[r] * spread[r]);
      Real* to = z.row(r);
      const Real* from = y + r * z.stride;
      for (int k = range.first; k < range.first + range.count; k += L::count) {
        L::store(L::load(to + k) * exp(s * L::load(from + k) + shift), to + k);
      }
    }
  }
};

}  // namespace slalom::detail::kernel
