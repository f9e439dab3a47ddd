#pragma once

#include "slalom/core/math.hpp"
#include "slalom/core/simd_operations.hpp"

namespace slalom::detail {

/// -2 log(x) for x in [2^-32, 1]: without the care of `log` for zero, negatives and infinity, and with a
/// polynomial whose relative error of 1e-6 no number of samples shows. Coefficients: least largest error on
/// [sqrt(1/2) - 1, sqrt(2) - 1].
template <class F>
SLALOM_INLINE F minus_two_log(const F& x) {
  using I = typename simd::IntPack<typename F::Target>::Vector;
  using V = typename F::Vector;
  const I bits = reinterpret_cast<I>(x.v);
  const I e = (bits - 0x3f3504f3) >> 23;
  const F m = F(reinterpret_cast<V>(bits - (e << 23))) - F(1.0f);
  const F n = F(__builtin_convertvector(e, V));
  const F p = polynomial(m, -0.24422094f, 0.37565732f, -0.40909559f, 0.4979356f, -0.66632055f, 1.00002797f,
                         -2.00000176f);
  return p * m + n * F(-1.38629436f);
}

/// Two standard normal values from 32 random bits (Box & Muller 1958). The top 31 give the radius; they give
/// the angle within half a turn as well, but with their bytes in reverse order: where the radius is known to
/// 24, 16 or 8 bits, the angle is still free in its first 8, 16 or 24. The last bit turns both round. So the
/// 2^32 pairs fill the plane evenly as far as anyone can see, at half the random bits of independent draws;
/// moments and tails of all of them are tested. The largest radius is 6.66.
template <class F>
SLALOM_INLINE_CALLS void normal_pair(const typename simd::detail::VectorTypes<F::lanes>::Unsigned& word,
                                     F& first, F& second) {
  using I = typename simd::IntPack<typename F::Target>::Vector;
  using V = typename F::Vector;
  const I bits = reinterpret_cast<I>(word >> 1);
  // (k + 1/2) 2^-31 for 0 <= k < 2^31; small values keep their precision.
  const F uniform = F(__builtin_convertvector(bits, V)) * F(0x1p-31f) + F(0x1p-32f);
  // Never 0, so that the reciprocal root stays finite: 1e-14 is a radius of 1e-7.
  const F squared = max(minus_two_log(uniform), F(1e-14f));
  const F radius = squared * reciprocal_sqrt(squared);
  I reversed = bits;
  simd::Operations<typename F::Target>::reverse_bytes(reversed);
  // In quarter turns; polynomials of least largest error, 6e-7 and 5e-8.
  const F angle = F(__builtin_convertvector(reversed, V)) * F(0x1p-31f);
  const F x2 = angle * angle;
  const F sine =
      angle * (F(1.57079101f) + x2 * (F(-0.64589285f) + x2 * (F(0.07943434f) + x2 * F(-0.0043331f))));
  const F cosine =
      F(0.999999953f) +
      x2 * (F(-1.23369821f) + x2 * (F(0.253650745f) + x2 * (F(-0.0208106275f) + x2 * F(0.000858190620f))));
  const F signed_radius(reinterpret_cast<V>(reinterpret_cast<I>(radius.v) ^ reinterpret_cast<I>(word << 31)));
  first = signed_radius * cosine;
  second = signed_radius * sine;
}

}  // namespace slalom::detail
