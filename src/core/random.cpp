#include "slalom/core/random.hpp"

#include "slalom/core/dispatch.hpp"
#include "slalom/core/math.hpp"

namespace slalom {

namespace {

using KeyWords = std::array<std::uint32_t, 4>;

KeyWords key_words(RandomKey key, std::uint32_t domain) {
  return {static_cast<std::uint32_t>(key.seed), static_cast<std::uint32_t>(key.seed >> 32),
          static_cast<std::uint32_t>(key.stream), static_cast<std::uint32_t>(key.stream >> 32) ^ domain};
}

constexpr std::uint32_t scalar_domain = 0x5ca1a800u, batch_domain = 0xba7c4000u;

/// -2 log(x) for x in [2^-33, 1]: without the care of `log` for zero, negatives and infinity, and with a
/// polynomial of degree 7 whose relative error of 1e-6 no number of samples shows. Coefficients:
/// interpolation of log(1 + m) / m at the Chebyshev nodes of [sqrt(1/2) - 1, sqrt(2) - 1].
template <class F>
SLALOM_INLINE F minus_two_log(const F& x) {
  using I = typename simd::IntPack<typename F::Target>::Vector;
  using V = typename F::Vector;
  const I bits = reinterpret_cast<I>(x.v);
  const I e = (bits - 0x3f3504f3) >> 23;
  const F m = F(reinterpret_cast<V>(bits - (e << 23))) - F(1.0f);
  const F n = F(__builtin_convertvector(e, V));
  F p = F(-0.233156123f);
  p = p * m + F(0.371476803f);
  p = p * m + F(-0.410508872f);
  p = p * m + F(0.498406725f);
  p = p * m + F(-0.666271266f);
  p = p * m + F(1.00001755f);
  p = p * m + F(-2.00000205f);
  return p * m + n * F(-1.38629436f);
}

/// Two standard normal values from two words (Box & Muller 1958): the radius from 1 - u with u in steps of
/// 2^-32, the angle as a quarter turn from the top two bits and a fraction of it from the others.
template <class F>
SLALOM_INLINE void box_muller(const typename simd::detail::VectorTypes<F::lanes>::Unsigned& a,
                              const typename simd::detail::VectorTypes<F::lanes>::Unsigned& b, F& first,
                              F& second) {
  using I = typename simd::IntPack<typename F::Target>::Vector;
  using V = typename F::Vector;
  // (k + 1/2) 2^-32 for 0 <= k < 2^32; small values keep their precision.
  const F uniform = F(__builtin_convertvector(a, V)) * F(0x1p-32f) + F(0x1p-33f);
  // Never 0, so that the reciprocal root stays finite: 1e-14 is a radius of 1e-7.
  const F squared = max(minus_two_log(uniform), F(1e-14f));
  const F radius = squared * reciprocal_sqrt(squared);
  // The signed fraction of a half turn; the top bit but one chooses sine or cosine, the top one the sign.
  const I fraction = reinterpret_cast<I>(b << 2);  // in 2^-31 quarter turns / 2
  const F angle = F(__builtin_convertvector(fraction, V)) * F(0.7853981634f / 2147483648.0f);
  const F x2 = angle * angle;
  const F s =
      angle + angle * x2 * (F(-1.6666654611e-1f) + x2 * (F(8.3321608736e-3f) + x2 * F(-1.9515295891e-4f)));
  const F c = (F(1.0f) - F(0.5f) * x2) +
              x2 * x2 * (F(4.166664568e-2f) + x2 * (F(-1.388731625e-3f) + x2 * F(2.443315712e-5f)));
  // Quarter turns: (c, s), (-s, c), (-c, -s), (s, -c).
  const I turned = reinterpret_cast<I>(b << 1);  // sign bit: an odd number of quarters
  const V cosine = turned < 0 ? s.v : c.v, sine = turned < 0 ? c.v : s.v;
  constexpr int sign = static_cast<int>(0x80000000u);
  const F signed_radius(reinterpret_cast<V>(reinterpret_cast<I>(radius.v) ^ (reinterpret_cast<I>(b) & sign)));
  first = signed_radius * F(reinterpret_cast<V>(reinterpret_cast<I>(cosine) ^ (turned & sign)));
  second = signed_radius * F(sine);
}

/// Four consecutive rows come from one block of Threefry, so a block a lane serves a pack of samples.
template <class Target>
SLALOM_INLINE void fill(SequenceBatch& batch, int first, int count, const KeyWords& given_key) {
  using F = Pack<Target>;
  using U = typename simd::detail::VectorTypes<F::lanes>::Unsigned;
  const KeyWords key = given_key;  // a copy, which no store can change: its schedule stays outside the loops
  const int rows = batch.steps() * batch.inputs();
  float* values = batch.row(0, 0);
  const std::ptrdiff_t stride = batch.stride();
  U lane{};
  for (int i = 0; i < F::lanes; ++i) lane[i] = static_cast<std::uint32_t>(i);
  for (int row = 0; row < rows; row += 4) {
    const int take = rows - row < 4 ? rows - row : 4;
    float* to = values + row * stride;
    for (int sample = first; sample < first + count; sample += F::lanes) {
      const std::array<U, 4> x =
          detail::threefry(U(lane + static_cast<std::uint32_t>(sample)),
                           U(U{} + static_cast<std::uint32_t>(row / 4)), U{}, U{}, key);
      F normal[4];
      box_muller<F>(x[0], x[1], normal[0], normal[1]);
      normal[0].store(to + sample);
      if (take > 1) normal[1].store(to + stride + sample);
      if (take > 2) {
        box_muller<F>(x[2], x[3], normal[2], normal[3]);
        normal[2].store(to + 2 * stride + sample);
        if (take > 3) normal[3].store(to + 3 * stride + sample);
      }
    }
  }
}

using Fill = void (*)(SequenceBatch&, int, int, const KeyWords&);

SLALOM_TARGET_GENERIC void fill_generic(SequenceBatch& b, int first, int count, const KeyWords& key) {
  fill<simd::Generic>(b, first, count, key);
}
#if SLALOM_X86
SLALOM_TARGET_SSE4 void fill_sse4(SequenceBatch& b, int first, int count, const KeyWords& key) {
  fill<simd::Sse4>(b, first, count, key);
}
SLALOM_TARGET_AVX2 void fill_avx2(SequenceBatch& b, int first, int count, const KeyWords& key) {
  fill<simd::Avx2>(b, first, count, key);
}
SLALOM_TARGET_AVX512 void fill_avx512(SequenceBatch& b, int first, int count, const KeyWords& key) {
  fill<simd::Avx512>(b, first, count, key);
}
#endif

Fill choose_fill() {
#if SLALOM_X86
  switch (simd::active_target()) {
    case simd::Target::avx512:
      return fill_avx512;
    case simd::Target::avx2:
      return fill_avx2;
    case simd::Target::sse4:
      return fill_sse4;
    case simd::Target::generic:
      break;
  }
#endif
  return fill_generic;
}

}  // namespace

void RandomStream::refill() noexcept {
  words_ = detail::threefry(static_cast<std::uint32_t>(block_), static_cast<std::uint32_t>(block_ >> 32), 0u,
                            0u, key_words(key_, scalar_domain));
  ++block_;
  used_ = 0;
}

void fill_normal(SequenceBatch& batch, int first, int count, RandomKey key) noexcept {
  static const Fill fill_rows = choose_fill();
  fill_rows(batch, first, count, key_words(key, batch_domain));
}

}  // namespace slalom
