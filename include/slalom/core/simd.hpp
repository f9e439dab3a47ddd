#pragma once

#include <concepts>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "slalom/core/instruction_set.hpp"

/// Packs of float32 lanes, so that one piece of template code runs a whole pack of samples at once.
///
/// A pack is made of the compiler's vector types: its operators are ordinary inline functions without an
/// instruction set. A kernel (dispatch.hpp) is compiled once per instruction set, into one function with that
/// set's target attribute, and everything it calls is inlined there; the vectors then become whole registers
/// of the set. So a user's problem runs at full width without any compiler flag, and one binary serves every
/// processor. Only where compilers do not find the right instruction (minimum and maximum, comparisons,
/// rounding, square roots, look-ups) does a pack call a function that is compiled for one instruction set.
/// Those are in simd_operations.hpp, with the large header of intrinsics: include dispatch.hpp where a kernel
/// runs, and this header where packs are only named.
///
/// Packs have a user-defined copy constructor on purpose: where a call is not inlined (unoptimised builds)
/// they are passed by reference in memory, so the calling convention does not depend on the instruction set.

namespace slalom {

/// A number that a problem multiplies with: kept in double for scalar code and, converted once, in float32
/// for SIMD lanes. A plain `double` member works as well, but is converted anew for every pack it meets.
///
///     T travelled = x.speed * T(time_step_);   // time_step_ is a Coefficient; T float, double or a pack
class Coefficient {
 public:
  /// Rounds `value` once.
  constexpr Coefficient(double value = 0) noexcept : exact_(value), rounded_(static_cast<float>(value)) {}

  /// The exact value.
  constexpr explicit operator double() const noexcept { return exact_; }
  /// The rounded value.
  constexpr explicit operator float() const noexcept { return rounded_; }
  /// The rounded value.
  constexpr float rounded() const noexcept { return rounded_; }

 private:
  double exact_;
  float rounded_;
};

}  // namespace slalom

namespace slalom::simd {

namespace detail {

template <int N>
struct VectorTypes {
  typedef float Float __attribute__((vector_size(4 * N)));
  typedef std::int32_t Int __attribute__((vector_size(4 * N)));
  typedef std::uint32_t Unsigned __attribute__((vector_size(4 * N)));
};

/// Whether products are rounded before they are added.
template <class T>
inline constexpr bool rounds_products = false;
template <class T>
inline constexpr bool rounds_products<Unfused<T>> = true;

/// The result of a comparison of packs: all bits of a lane are 1 if it is true, else 0.
template <class T>
struct MaskVector {
  using type = typename VectorTypes<T::lanes>::Int;
};
/// AVX-512 compares into registers of one bit per lane, and selects by them.
template <>
struct MaskVector<Avx512> {
  using type = std::uint16_t;
};
template <class T>
struct MaskVector<Unfused<T>> : MaskVector<T> {};

/// One value in all lanes. x - 0 is x for every x, and so folds to a broadcast. But g++ builds a vector wider
/// than the baseline's lane by lane, unless it is told the instruction (simd_operations.hpp).
template <class T>
struct Broadcast {
  static void of(float value, typename VectorTypes<T::lanes>::Float& r) {
    r = value - typename VectorTypes<T::lanes>::Float{};
  }
};
#if SLALOM_X86
template <>
struct Broadcast<Avx2>;
template <>
struct Broadcast<Avx512>;
#endif
template <class T>
struct Broadcast<Unfused<T>> : Broadcast<T> {};

}  // namespace detail

/// Operations for which compilers need to be told the instruction: simd_operations.hpp.
template <class T>
struct Operations;

/// One truth value per lane.
template <class T>
struct Mask {
  using Vector = typename detail::MaskVector<T>::type;      ///< vector type of the compiler
  static constexpr bool bits = std::is_integral_v<Vector>;  ///< one bit per lane
  Vector v;  ///< with `bits` one bit per lane; else all bits of a lane, 1 where true and 0 where false

  Mask() = default;
  /// Takes a vector in this form.
  SLALOM_INLINE Mask(const Vector& vector) : v(vector) {}
  SLALOM_INLINE Mask(const Mask& other) : v(other.v) {}
  SLALOM_INLINE Mask& operator=(const Mask& other) {
    v = other.v;
    return *this;
  }
  /// Sets all lanes to `value`.
  SLALOM_INLINE explicit Mask(bool value) {
    if constexpr (bits) {
      v = static_cast<Vector>(-static_cast<int>(value));
    } else {
      v = Vector{} - static_cast<int>(value);
    }
  }

  SLALOM_INLINE friend Mask operator&(const Mask& a, const Mask& b) {
    return Mask(static_cast<Vector>(a.v & b.v));
  }
  SLALOM_INLINE friend Mask operator|(const Mask& a, const Mask& b) {
    return Mask(static_cast<Vector>(a.v | b.v));
  }
  SLALOM_INLINE friend Mask operator!(const Mask& a) { return Mask(static_cast<Vector>(~a.v)); }
  SLALOM_INLINE friend Mask operator&&(const Mask& a, const Mask& b) { return a & b; }
  SLALOM_INLINE friend Mask operator||(const Mask& a, const Mask& b) { return a | b; }
  /// Refuses `if (x > 0)`, `x > 0 ? a : b` and `bool far = x > 0` of packs, with words.
  template <std::same_as<bool> Bool>
  operator Bool() const {
    static_assert(
        sizeof(Bool) == 0,
        "slalom: this condition differs from lane to lane: write slalom::select(condition, a, b), or "
        "slalom::any(condition) or slalom::all(condition) where one answer for all lanes will do");
    return false;
  }
  /// Writes 1 for each lane that is true, else 0.
  SLALOM_INLINE_CALLS void store(std::uint8_t* to) const { Operations<T>::store_mask(v, to); }
  bool operator[](int lane) const {
    if constexpr (bits) {
      return ((v >> lane) & 1) != 0;
    } else {
      return v[lane] != 0;
    }
  }
};

/// A pack of 32-bit integers.
template <class T>
struct IntPack {
  using Vector = typename detail::VectorTypes<T::lanes>::Int;  ///< vector type of the compiler
  Vector v;                                                    ///< the lanes

  IntPack() = default;
  /// Sets all lanes to `value`.
  SLALOM_INLINE explicit IntPack(int value) { v = Vector{} + value; }
  /// Takes a vector.
  SLALOM_INLINE IntPack(const Vector& vector) : v(vector) {}
  SLALOM_INLINE IntPack(const IntPack& other) : v(other.v) {}
  SLALOM_INLINE IntPack& operator=(const IntPack& other) {
    v = other.v;
    return *this;
  }

  SLALOM_INLINE friend IntPack operator+(const IntPack& a, const IntPack& b) { return IntPack(a.v + b.v); }
  SLALOM_INLINE friend IntPack operator*(const IntPack& a, int b) { return IntPack(a.v * b); }
  SLALOM_INLINE_CALLS friend Mask<T> operator<(const IntPack& a, const IntPack& b) {
    Mask<T> r;
    Operations<T>::less(a.v, b.v, r.v);
    return r;
  }
  SLALOM_INLINE_CALLS friend Mask<T> operator>(const IntPack& a, const IntPack& b) { return b < a; }
  SLALOM_INLINE_CALLS friend Mask<T> operator==(const IntPack& a, const IntPack& b) {
    Mask<T> r;
    Operations<T>::equal(a.v, b.v, r.v);
    return r;
  }
};

/// A type that may stand beside a pack for one value in all lanes.
template <class N>
concept Number = std::same_as<N, int> || std::same_as<N, float> || std::same_as<N, double>;

/// A pack of float32 values: arithmetic like a float's, lane by lane.
template <class T>
struct Pack {
  using Target = T;                                              ///< the instruction set
  using Vector = typename detail::VectorTypes<T::lanes>::Float;  ///< vector type of the compiler
  static constexpr int lanes = T::lanes;                         ///< number of float32 values
  Vector v;                                                      ///< the lanes

  Pack() = default;
  /// Sets all lanes to `value`.
  SLALOM_INLINE_CALLS Pack(float value) { detail::Broadcast<T>::of(value, v); }
  /// Sets all lanes to `value`, rounded to float32.
  SLALOM_INLINE Pack(double value) : Pack(static_cast<float>(value)) {}
  /// Sets all lanes to `value`.
  SLALOM_INLINE Pack(int value) : Pack(static_cast<float>(value)) {}
  /// Sets all lanes to a value that is already rounded.
  SLALOM_INLINE Pack(const Coefficient& value) : Pack(value.rounded()) {}
  /// Takes a vector.
  SLALOM_INLINE Pack(const Vector& vector) : v(vector) {}
  SLALOM_INLINE Pack(const Pack& other) : v(other.v) {}
  SLALOM_INLINE Pack& operator=(const Pack& other) {
    v = other.v;
    return *this;
  }

  /// Reads one value for each lane.
  SLALOM_INLINE static Pack load(const float* from) {
    Pack p;
    std::memcpy(&p.v, from, sizeof p.v);
    return p;
  }
  /// Writes the lanes.
  SLALOM_INLINE void store(float* to) const { std::memcpy(to, &v, sizeof v); }
  float operator[](int lane) const { return v[lane]; }  ///< value of one lane
  /// Refuses, with a message, uses of a pack as one number, such as `std::sin(x)` and `double y = x`.
  template <std::same_as<double> Double>
  operator Double() const {
    static_assert(sizeof(Double) == 0,
                  "slalom: T holds a number for each lane and is not a double: write slalom::sin(x), "
                  "slalom::exp(x) and so on "
                  "in place of std::sin(x), and T for the type of variables");
    return 0;
  }
  /// Refuses a pack as an index, such as `table[int(x)]`.
  template <std::integral Integer>
  explicit operator Integer() const {
    static_assert(sizeof(Integer) == 0,
                  "slalom: T holds a number for each lane and is no index: look values up with a "
                  "slalom::maps::Field or a slalom::GridView, or choose them with slalom::select");
    return 0;
  }

  SLALOM_INLINE friend Pack operator+(const Pack& a, const Pack& b) { SLALOM_FUSE return Pack(a.v + b.v); }
  SLALOM_INLINE friend Pack operator-(const Pack& a, const Pack& b) { SLALOM_FUSE return Pack(a.v - b.v); }
  SLALOM_INLINE friend Pack operator*(const Pack& a, const Pack& b) {
    if constexpr (detail::rounds_products<T>) {
      Vector product = a.v * b.v;
      SLALOM_ROUND(product);
      return Pack(product);
    } else {
      SLALOM_FUSE return Pack(a.v * b.v);
    }
  }
  SLALOM_INLINE friend Pack operator/(const Pack& a, const Pack& b) { return Pack(a.v / b.v); }
  SLALOM_INLINE friend Pack operator-(const Pack& a) { return Pack(-a.v); }
  SLALOM_INLINE Pack& operator+=(const Pack& b) { return *this = *this + b; }
  SLALOM_INLINE Pack& operator-=(const Pack& b) { return *this = *this - b; }
  SLALOM_INLINE Pack& operator*=(const Pack& b) { return *this = *this * b; }
  SLALOM_INLINE Pack& operator/=(const Pack& b) { return *this = *this / b; }

  SLALOM_INLINE_CALLS friend Mask<T> operator<(const Pack& a, const Pack& b) {
    Mask<T> r;
    Operations<T>::less(a.v, b.v, r.v);
    return r;
  }
  SLALOM_INLINE_CALLS friend Mask<T> operator<=(const Pack& a, const Pack& b) {
    Mask<T> r;
    Operations<T>::less_or_equal(a.v, b.v, r.v);
    return r;
  }
  SLALOM_INLINE_CALLS friend Mask<T> operator>(const Pack& a, const Pack& b) { return b < a; }
  SLALOM_INLINE_CALLS friend Mask<T> operator>=(const Pack& a, const Pack& b) { return b <= a; }
  SLALOM_INLINE_CALLS friend Mask<T> operator==(const Pack& a, const Pack& b) { return (a <= b) & (b <= a); }
  SLALOM_INLINE_CALLS friend Mask<T> operator!=(const Pack& a, const Pack& b) { return !(a == b); }
};

/// An operator of a pack and a number, which stands for the same value in all lanes.
#define SLALOM_MIXED_OPERATOR(Result, op)                            \
  template <class T, Number N>                                       \
  SLALOM_INLINE_CALLS Result<T> operator op(const Pack<T>& a, N b) { \
    return a op Pack<T>(b);                                          \
  }                                                                  \
  template <class T, Number N>                                       \
  SLALOM_INLINE_CALLS Result<T> operator op(N a, const Pack<T>& b) { \
    return Pack<T>(a) op b;                                          \
  }
SLALOM_MIXED_OPERATOR(Pack, +)
SLALOM_MIXED_OPERATOR(Pack, -)
SLALOM_MIXED_OPERATOR(Pack, *)
SLALOM_MIXED_OPERATOR(Pack, /)
SLALOM_MIXED_OPERATOR(Mask, <)
SLALOM_MIXED_OPERATOR(Mask, <=)
SLALOM_MIXED_OPERATOR(Mask, >)
SLALOM_MIXED_OPERATOR(Mask, >=)
SLALOM_MIXED_OPERATOR(Mask, ==)
SLALOM_MIXED_OPERATOR(Mask, !=)
#undef SLALOM_MIXED_OPERATOR

}  // namespace slalom::simd
