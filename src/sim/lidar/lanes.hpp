#pragma once

#include <cstdint>
#include <cstring>

#if defined(__AVX2__)
#include <immintrin.h>
#endif

/// Packs of lanes as the compiler's vector types, and the few operations for which it needs to be told the
/// instruction. Unlike the packs of the core these never fuse a product with a sum, so that every instruction
/// set gives the same bits. A file that includes this is compiled for one instruction set; nothing of it may
/// be seen by another.
namespace slalom::sim::detail {
namespace {

template <int N>
struct Lanes {
  typedef float F __attribute__((vector_size(4 * N)));
  typedef std::int32_t I __attribute__((vector_size(4 * N)));
  typedef std::uint32_t U __attribute__((vector_size(4 * N)));
  // Half as many in double precision, with the integers that go with them.
  typedef double D __attribute__((vector_size(4 * N)));
  typedef std::int64_t M __attribute__((vector_size(4 * N)));
  typedef std::int32_t J __attribute__((vector_size(2 * N)));
};

/// The portable forms; `N` lanes.
template <int N>
struct Portable {
  static constexpr int lanes = N;
  using F = typename Lanes<N>::F;
  using I = typename Lanes<N>::I;
  using U = typename Lanes<N>::U;
  using D = typename Lanes<N>::D;
  using M = typename Lanes<N>::M;
  using J = typename Lanes<N>::J;

  static void load(const float* from, F& r) { std::memcpy(&r, from, sizeof r); }
  static void store(const F& a, float* to) { std::memcpy(to, &a, sizeof a); }
  static void min(const F& a, const F& b, F& r) { r = a < b ? a : b; }
  static void max(const F& a, const F& b, F& r) { r = a > b ? a : b; }
  static void sqrt(const F& a, F& r) {
    for (int i = 0; i < N; ++i) r[i] = __builtin_sqrtf(a[i]);
  }
  /// Towards zero.
  static void to_int(const F& a, I& r) { r = __builtin_convertvector(a, I); }
  static void to_float(const I& a, F& r) { r = __builtin_convertvector(a, F); }
  /// 16-bit values; may read the 2 bytes after them.
  static void gather(const std::int16_t* from, const I& index, I& r) {
    for (int i = 0; i < N; ++i) r[i] = from[index[i]];
  }
  static bool any(const I& mask) {
    std::int32_t all = 0;
    for (int i = 0; i < N; ++i) all |= mask[i];
    return all != 0;
  }
  static void gather(const double* from, const J& index, D& r) {
    D found = D{};
    for (int i = 0; i < N / 2; ++i) found[i] = from[index[i]];
    r = found;
  }
  static bool any(const M& mask) {
    std::int64_t all = 0;
    for (int i = 0; i < N / 2; ++i) all |= mask[i];
    return all != 0;
  }
};

struct Baseline : Portable<4> {};

#if defined(__AVX2__)
struct Avx2 : Portable<8> {
  static void min(const F& a, const F& b, F& r) { r = (F)_mm256_min_ps((__m256)a, (__m256)b); }
  static void max(const F& a, const F& b, F& r) { r = (F)_mm256_max_ps((__m256)a, (__m256)b); }
  static void sqrt(const F& a, F& r) { r = (F)_mm256_sqrt_ps((__m256)a); }
  static void gather(const std::int16_t* from, const I& index, I& r) {
    const __m256i both = _mm256_i32gather_epi32(reinterpret_cast<const int*>(from), (__m256i)index, 2);
    r = (I)_mm256_srai_epi32(_mm256_slli_epi32(both, 16), 16);
  }
  static bool any(const I& mask) { return _mm256_movemask_ps((__m256)mask) != 0; }
  static void gather(const double* from, const J& index, D& r) {
    const __m256d all = (__m256d)_mm256_set1_epi64x(-1);  // as below: without a mask a false warning
    r = (D)_mm256_mask_i32gather_pd(_mm256_setzero_pd(), from, (__m128i)index, all, 8);
  }
  static bool any(const M& mask) { return _mm256_movemask_pd((__m256d)mask) != 0; }
};

#endif

#if defined(__AVX512F__)
struct Avx512 : Portable<16> {
  static constexpr __mmask16 all = 0xffff;  // the forms without a mask trip a false warning of g++ 12
  static void min(const F& a, const F& b, F& r) { r = (F)_mm512_maskz_min_ps(all, (__m512)a, (__m512)b); }
  static void max(const F& a, const F& b, F& r) { r = (F)_mm512_maskz_max_ps(all, (__m512)a, (__m512)b); }
  static void sqrt(const F& a, F& r) { r = (F)_mm512_maskz_sqrt_ps(all, (__m512)a); }
  static void gather(const std::int16_t* from, const I& index, I& r) {
    const __m512i both = _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), all, (__m512i)index,
                                                     reinterpret_cast<const int*>(from), 2);
    r = (I)_mm512_maskz_srai_epi32(all, _mm512_maskz_slli_epi32(all, both, 16), 16);
  }
  static bool any(const I& mask) { return _mm512_test_epi32_mask((__m512i)mask, (__m512i)mask) != 0; }
  static void gather(const double* from, const J& index, D& r) {
    r = (D)_mm512_mask_i32gather_pd(_mm512_setzero_pd(), 0xff, (__m256i)index, from, 8);
  }
  static bool any(const M& mask) { return _mm512_test_epi64_mask((__m512i)mask, (__m512i)mask) != 0; }
};
#endif

}  // namespace
}  // namespace slalom::sim::detail
