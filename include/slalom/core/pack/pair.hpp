#pragma once

#include "slalom/core/pack/functions.hpp"

/// Two packs that take part in each operation together. A step of several hundred instructions is longer than
/// a processor looks ahead, so the next pack's step cannot hide the latencies of this one; the other half of
/// a pair does. Each half has the bits that it has alone. Rollouts use pairs for problems that say `static
/// constexpr bool long_steps = true`.
namespace slalom::simd {

/// Stands in place of an instruction set: pairs of its packs.
template <class T>
struct Pair {
  static constexpr int lanes = 2 * T::lanes;  ///< number of float32 values
  static constexpr bool fused = T::fused;     ///< whether it has fused multiply-add
};

/// One truth value per lane of a pair.
template <class T>
struct Mask<Pair<T>> {
  Mask<T> low, high;  ///< masks of the first lanes and of the others

  Mask() = default;
  /// Joins two halves.
  SLALOM_INLINE Mask(const Mask<T>& a, const Mask<T>& b) : low(a), high(b) {}
  /// Sets all lanes to `value`.
  SLALOM_INLINE explicit Mask(bool value) : low(value), high(value) {}

  SLALOM_INLINE friend Mask operator&(const Mask& a, const Mask& b) {
    return Mask(a.low & b.low, a.high & b.high);
  }
  SLALOM_INLINE friend Mask operator|(const Mask& a, const Mask& b) {
    return Mask(a.low | b.low, a.high | b.high);
  }
  SLALOM_INLINE friend Mask operator!(const Mask& a) { return Mask(!a.low, !a.high); }
  SLALOM_INLINE friend Mask operator&&(const Mask& a, const Mask& b) { return a & b; }
  SLALOM_INLINE friend Mask operator||(const Mask& a, const Mask& b) { return a | b; }
  /// Writes 1 for each lane that is true, else 0.
  SLALOM_INLINE void store(std::uint8_t* to) const {
    low.store(to);
    high.store(to + T::lanes);
  }
  bool operator[](int lane) const { return lane < T::lanes ? low[lane] : high[lane - T::lanes]; }
};

/// A pair of packs: arithmetic like a float's, lane by lane.
template <class T>
struct Pack<Pair<T>> {
  using Target = Pair<T>;                      ///< stands in place of an instruction set
  static constexpr int lanes = Target::lanes;  ///< number of float32 values
  Pack<T> low, high;                           ///< the first lanes and the others

  Pack() = default;
  /// Joins two halves.
  SLALOM_INLINE Pack(const Pack<T>& a, const Pack<T>& b) : low(a), high(b) {}
  /// Sets all lanes to `value`.
  SLALOM_INLINE_CALLS Pack(float value) : low(value), high(low) {}
  /// Sets all lanes to `value`, rounded to float32.
  SLALOM_INLINE Pack(double value) : Pack(static_cast<float>(value)) {}
  /// Sets all lanes to `value`.
  SLALOM_INLINE Pack(int value) : Pack(static_cast<float>(value)) {}
  /// Sets all lanes to a value that is already rounded.
  SLALOM_INLINE Pack(const Coefficient& value) : Pack(value.rounded()) {}

  /// Reads one value for each lane.
  SLALOM_INLINE static Pack load(const float* from) {
    return Pack(Pack<T>::load(from), Pack<T>::load(from + T::lanes));
  }
  /// Writes the lanes.
  SLALOM_INLINE void store(float* to) const {
    low.store(to);
    high.store(to + T::lanes);
  }
  float operator[](int lane) const { return lane < T::lanes ? low[lane] : high[lane - T::lanes]; }

  SLALOM_INLINE friend Pack operator-(const Pack& a) { return Pack(-a.low, -a.high); }

/// An operator of two pairs.
#define SLALOM_PAIR_OPERATOR(Result, op)                                        \
  SLALOM_INLINE_CALLS friend Result operator op(const Pack& a, const Pack& b) { \
    return Result(a.low op b.low, a.high op b.high);                            \
  }
  SLALOM_PAIR_OPERATOR(Pack, +)
  SLALOM_PAIR_OPERATOR(Pack, -)
  SLALOM_PAIR_OPERATOR(Pack, *)
  SLALOM_PAIR_OPERATOR(Pack, /)
  SLALOM_PAIR_OPERATOR(Mask<Target>, <)
  SLALOM_PAIR_OPERATOR(Mask<Target>, <=)
  SLALOM_PAIR_OPERATOR(Mask<Target>, >)
  SLALOM_PAIR_OPERATOR(Mask<Target>, >=)
  SLALOM_PAIR_OPERATOR(Mask<Target>, ==)
  SLALOM_PAIR_OPERATOR(Mask<Target>, !=)
#undef SLALOM_PAIR_OPERATOR

  SLALOM_INLINE Pack& operator+=(const Pack& b) {
    return *this = *this + b;
  }
  SLALOM_INLINE Pack& operator-=(const Pack& b) {
    return *this = *this - b;
  }
  SLALOM_INLINE Pack& operator*=(const Pack& b) {
    return *this = *this * b;
  }
  SLALOM_INLINE Pack& operator/=(const Pack& b) {
    return *this = *this / b;
  }
};

}  // namespace slalom::simd

namespace slalom {

/// Two packs that take part in each operation together.
template <class T>
using PackPair = Pack<simd::Pair<T>>;

/// Functions of a pair are those of its halves.
#define SLALOM_PAIR_FUNCTION(name)                             \
  template <class T>                                           \
  SLALOM_INLINE_CALLS PackPair<T> name(const PackPair<T>& x) { \
    return {name(x.low), name(x.high)};                        \
  }
SLALOM_PAIR_FUNCTION(sqrt)
SLALOM_PAIR_FUNCTION(reciprocal_sqrt)
SLALOM_PAIR_FUNCTION(round)
SLALOM_PAIR_FUNCTION(floor)
SLALOM_PAIR_FUNCTION(ceil)
SLALOM_PAIR_FUNCTION(abs)
SLALOM_PAIR_FUNCTION(sign)
SLALOM_PAIR_FUNCTION(sin)
SLALOM_PAIR_FUNCTION(cos)
SLALOM_PAIR_FUNCTION(tan)
SLALOM_PAIR_FUNCTION(asin)
SLALOM_PAIR_FUNCTION(acos)
SLALOM_PAIR_FUNCTION(atan)
SLALOM_PAIR_FUNCTION(sinh)
SLALOM_PAIR_FUNCTION(cosh)
SLALOM_PAIR_FUNCTION(tanh)
SLALOM_PAIR_FUNCTION(exp)
SLALOM_PAIR_FUNCTION(exp2)
SLALOM_PAIR_FUNCTION(log)
SLALOM_PAIR_FUNCTION(log1p)
SLALOM_PAIR_FUNCTION(cbrt)
#undef SLALOM_PAIR_FUNCTION

/// Functions of two pairs.
#define SLALOM_PAIR_FUNCTION(name)                                                                         \
  template <class T>                                                                                       \
  SLALOM_INLINE_CALLS PackPair<T> name(const PackPair<T>& a, const std::type_identity_t<PackPair<T>>& b) { \
    return {name(a.low, b.low), name(a.high, b.high)};                                                     \
  }
SLALOM_PAIR_FUNCTION(min)
SLALOM_PAIR_FUNCTION(max)
SLALOM_PAIR_FUNCTION(copysign)
SLALOM_PAIR_FUNCTION(fmod)
SLALOM_PAIR_FUNCTION(pow)
SLALOM_PAIR_FUNCTION(hypot)
SLALOM_PAIR_FUNCTION(atan2)
#undef SLALOM_PAIR_FUNCTION

/// `a` in lanes where the condition is true, else `b`.
template <class T>
SLALOM_INLINE_CALLS PackPair<T> select(const simd::Mask<simd::Pair<T>>& condition, const PackPair<T>& a,
                                       const std::type_identity_t<PackPair<T>>& b) {
  return {select(condition.low, a.low, b.low), select(condition.high, a.high, b.high)};
}
/// Whether any lane is set.
template <class T>
SLALOM_INLINE_CALLS bool any(const simd::Mask<simd::Pair<T>>& mask) {
  return any(mask.low | mask.high);
}
/// Whether all lanes are set.
template <class T>
SLALOM_INLINE_CALLS bool all(const simd::Mask<simd::Pair<T>>& mask) {
  return !any(!mask);
}
/// Sine and cosine together.
template <class T>
SLALOM_INLINE void sin_cos(const PackPair<T>& x, PackPair<T>& s, PackPair<T>& c) {
  sin_cos(x.low, s.low, c.low);
  sin_cos(x.high, s.high, c.high);
}

}  // namespace slalom
