#pragma once

#include "slalom/core/simd.hpp"

#if defined(__aarch64__)
#include <arm_neon.h>
#elif SLALOM_X86
#include <immintrin.h>
#endif

/// The few pack operations for which the compilers need to be told the instruction, one struct per
/// instruction set. Packs are passed and returned by reference, so that the calling convention does not
/// depend on the instruction set.
namespace slalom::simd {

namespace detail {

#if SLALOM_X86
template <>
struct Broadcast<Avx2> {
  SLALOM_ISA_AVX2 static void of(float value, VectorTypes<8>::Float& r) {
    r = reinterpret_cast<VectorTypes<8>::Float>(_mm256_set1_ps(value));
  }
};
template <>
struct Broadcast<Avx512> {
  SLALOM_ISA_AVX512 static void of(float value, VectorTypes<16>::Float& r) {
    r = reinterpret_cast<VectorTypes<16>::Float>(_mm512_set1_ps(value));
  }
};
#endif

}  // namespace detail

/// Portable implementations of the operations, for those that an instruction set does not override.
template <class T>
struct PortableOperations {
  using F = typename Pack<T>::Vector;
  using I = typename IntPack<T>::Vector;
  static constexpr int lanes = T::lanes;

  static void min(const F& a, const F& b, F& r) { r = a < b ? a : b; }
  static void max(const F& a, const F& b, F& r) { r = a > b ? a : b; }
  /// a - b c, rounded once on AVX2, AVX-512 and NEON and twice elsewhere, whichever products and sums the
  /// compiler fuses.
  static void subtract_product(const F& a, const F& b, const F& c, F& r) { r = a - b * c; }
  static void less(const F& a, const F& b, I& r) { r = a < b; }
  static void less_or_equal(const F& a, const F& b, I& r) { r = a <= b; }
  static void less(const I& a, const I& b, I& r) { r = a < b; }
  static void equal(const I& a, const I& b, I& r) { r = a == b; }
  /// Whether any lane is set.
  static bool any(const I& mask) {
    std::int32_t all = 0;
    for (int i = 0; i < lanes; ++i) all |= mask[i];
    return all != 0;
  }
  /// `a` where all bits of the condition are set, `b` where none is.
  static void select(const I& condition, const F& a, const F& b, F& r) { r = condition ? a : b; }
  /// Writes one byte for each lane: 1 if it is set, else 0.
  static void store_mask(const I& mask, std::uint8_t* to) {
    for (int i = 0; i < lanes; ++i) to[i] = mask[i] != 0;
  }
  static void sqrt(const F& a, F& r) {
    for (int i = 0; i < lanes; ++i) r[i] = __builtin_sqrtf(a[i]);
  }
  static void reciprocal_sqrt(const F& a, F& r) {
    for (int i = 0; i < lanes; ++i) r[i] = 1.0f / __builtin_sqrtf(a[i]);
  }
  /// Adding 1.5 * 2^23 rounds to the nearest integer; for |a| < 2^22.
  static void round(const F& a, F& r) {
    const F magic = F{} + 12582912.0f;
    r = (a + magic) - magic;
  }
  static void shift_left(I& a, int count) { a = a << count; }
  static void reverse_bytes(I& a) {
    a = (a << 24) | ((a & 0xff00) << 8) | ((a >> 8) & 0xff00) | ((a >> 24) & 0xff);
  }
  static void gather(const float* from, const I& index, F& r) {
    for (int i = 0; i < lanes; ++i) r[i] = from[index[i]];
  }
  /// 16-bit values; may read the 2 bytes after them.
  static void gather(const std::int16_t* from, const I& index, I& r) {
    for (int i = 0; i < lanes; ++i) r[i] = from[index[i]];
  }
  /// Reads the 16-byte cell `index` of every lane and returns its four values as four packs.
  static void gather_cells(const float* from, const I& index, F& r0, F& r1, F& r2, F& r3) {
    for (int i = 0; i < lanes; ++i) {
      const float* cell = from + 4 * static_cast<std::ptrdiff_t>(index[i]);
      r0[i] = cell[0];
      r1[i] = cell[1];
      r2[i] = cell[2];
      r3[i] = cell[3];
    }
  }
};

#if defined(__aarch64__)
template <>
struct Operations<Generic> : PortableOperations<Generic> {
  static void min(const F& a, const F& b, F& r) { r = (F)vminq_f32((float32x4_t)a, (float32x4_t)b); }
  static void max(const F& a, const F& b, F& r) { r = (F)vmaxq_f32((float32x4_t)a, (float32x4_t)b); }
  static void subtract_product(const F& a, const F& b, const F& c, F& r) {
    r = (F)vfmsq_f32((float32x4_t)a, (float32x4_t)b, (float32x4_t)c);
  }
  static void reverse_bytes(I& a) { a = (I)vrev32q_u8((uint8x16_t)a); }
  static void sqrt(const F& a, F& r) { r = (F)vsqrtq_f32((float32x4_t)a); }
  static void reciprocal_sqrt(const F& a, F& r) { r = 1.0f / (F)vsqrtq_f32((float32x4_t)a); }
  static void round(const F& a, F& r) { r = (F)vrndnq_f32((float32x4_t)a); }
  static void gather_cells(const float* from, const I& index, F& r0, F& r1, F& r2, F& r3) {
    const float32x4_t a = vld1q_f32(from + 4 * static_cast<std::ptrdiff_t>(index[0]));
    const float32x4_t b = vld1q_f32(from + 4 * static_cast<std::ptrdiff_t>(index[1]));
    const float32x4_t c = vld1q_f32(from + 4 * static_cast<std::ptrdiff_t>(index[2]));
    const float32x4_t d = vld1q_f32(from + 4 * static_cast<std::ptrdiff_t>(index[3]));
    const float64x2_t t0 = vreinterpretq_f64_f32(vzip1q_f32(a, b)),
                      t1 = vreinterpretq_f64_f32(vzip2q_f32(a, b));
    const float64x2_t t2 = vreinterpretq_f64_f32(vzip1q_f32(c, d)),
                      t3 = vreinterpretq_f64_f32(vzip2q_f32(c, d));
    r0 = (F)vzip1q_f64(t0, t2);
    r1 = (F)vzip2q_f64(t0, t2);
    r2 = (F)vzip1q_f64(t1, t3);
    r3 = (F)vzip2q_f64(t1, t3);
  }
};
#else
template <>
struct Operations<Generic> : PortableOperations<Generic> {};
#endif

#if SLALOM_X86
namespace detail {
/// Bytes 3 2 1 0, 7 6 5 4, ...: the order of a shuffle that reverses the bytes of each 32-bit lane.
inline constexpr __m128i reversed_bytes = {0x0405060700010203, 0x0c0d0e0f08090a0b};
}  // namespace detail

/// The lanes of two vectors with these indices, as one vector.
#define SLALOM_SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)

template <>
struct Operations<Sse4> : PortableOperations<Sse4> {
  SLALOM_ISA_SSE4 static void min(const F& a, const F& b, F& r) { r = (F)_mm_min_ps((__m128)a, (__m128)b); }
  SLALOM_ISA_SSE4 static void max(const F& a, const F& b, F& r) { r = (F)_mm_max_ps((__m128)a, (__m128)b); }
  SLALOM_ISA_SSE4 static void sqrt(const F& a, F& r) { r = (F)_mm_sqrt_ps((__m128)a); }
  SLALOM_ISA_SSE4 static void reciprocal_sqrt(const F& a, F& r) {
    const F e = (F)_mm_rsqrt_ps((__m128)a);
    r = e * (1.5f - 0.5f * a * e * e);
  }
  SLALOM_ISA_SSE4 static void round(const F& a, F& r) {
    r = (F)_mm_round_ps((__m128)a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
  }
  SLALOM_ISA_SSE4 static void reverse_bytes(I& a) {
    a = (I)_mm_shuffle_epi8((__m128i)a, detail::reversed_bytes);
  }
  SLALOM_ISA_SSE4 static bool any(const I& mask) { return _mm_movemask_ps((__m128)mask) != 0; }
  SLALOM_ISA_SSE4 static void gather_cells(const float* from, const I& index, F& r0, F& r1, F& r2, F& r3) {
    __m128 a = _mm_loadu_ps(from + 4 * static_cast<std::ptrdiff_t>(index[0]));
    __m128 b = _mm_loadu_ps(from + 4 * static_cast<std::ptrdiff_t>(index[1]));
    __m128 c = _mm_loadu_ps(from + 4 * static_cast<std::ptrdiff_t>(index[2]));
    __m128 d = _mm_loadu_ps(from + 4 * static_cast<std::ptrdiff_t>(index[3]));
    _MM_TRANSPOSE4_PS(a, b, c, d);
    r0 = (F)a;
    r1 = (F)b;
    r2 = (F)c;
    r3 = (F)d;
  }
};

template <>
struct Operations<Avx2> : PortableOperations<Avx2> {
  SLALOM_ISA_AVX2 static void min(const F& a, const F& b, F& r) {
    r = (F)_mm256_min_ps((__m256)a, (__m256)b);
  }
  SLALOM_ISA_AVX2 static void max(const F& a, const F& b, F& r) {
    r = (F)_mm256_max_ps((__m256)a, (__m256)b);
  }
  SLALOM_ISA_AVX2 static void subtract_product(const F& a, const F& b, const F& c, F& r) {
    r = (F)_mm256_fnmadd_ps((__m256)b, (__m256)c, (__m256)a);
  }
  SLALOM_ISA_AVX2 static void sqrt(const F& a, F& r) { r = (F)_mm256_sqrt_ps((__m256)a); }
  SLALOM_ISA_AVX2 static void reciprocal_sqrt(const F& a, F& r) {
    const F e = (F)_mm256_rsqrt_ps((__m256)a);
    r = e * (1.5f - 0.5f * a * e * e);
  }
  SLALOM_ISA_AVX2 static void round(const F& a, F& r) {
    r = (F)_mm256_round_ps((__m256)a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
  }
  /// Takes a count for each lane: one micro-operation, where a count for all lanes takes two.
  SLALOM_ISA_AVX2 static void shift_left(I& a, int count) {
    a = (I)_mm256_sllv_epi32((__m256i)a, _mm256_set1_epi32(count));
  }
  SLALOM_ISA_AVX2 static void reverse_bytes(I& a) {
    a = (I)_mm256_shuffle_epi8((__m256i)a, _mm256_broadcastsi128_si256(detail::reversed_bytes));
  }
  SLALOM_ISA_AVX2 static bool any(const I& mask) { return _mm256_movemask_ps((__m256)mask) != 0; }
  SLALOM_ISA_AVX2 static void gather(const float* from, const I& index, F& r) {
    r = (F)_mm256_i32gather_ps(from, (__m256i)index, 4);
  }
  SLALOM_ISA_AVX2 static void gather(const std::int16_t* from, const I& index, I& r) {
    const __m256i both = _mm256_i32gather_epi32(reinterpret_cast<const int*>(from), (__m256i)index, 2);
    r = (I)_mm256_srai_epi32(_mm256_slli_epi32(both, 16), 16);
  }
  SLALOM_ISA_AVX2 static void gather_cells(const float* from, const I& index, F& r0, F& r1, F& r2, F& r3) {
    alignas(32) std::int32_t at[8];
    *reinterpret_cast<I*>(at) = index << 2;
    __asm__("" : "+m"(at));  // otherwise g++ extracts each lane from the register, which is slower
    F row[4];
    for (int k = 0; k < 4; ++k) {
      row[k] = (F)SLALOM_SHUFFLE(_mm_loadu_ps(from + at[k]), _mm_loadu_ps(from + at[k + 4]), 0, 1, 2, 3, 4, 5,
                                 6, 7);
    }
    const F t0 = SLALOM_SHUFFLE(row[0], row[1], 0, 8, 1, 9, 4, 12, 5, 13);
    const F t1 = SLALOM_SHUFFLE(row[0], row[1], 2, 10, 3, 11, 6, 14, 7, 15);
    const F t2 = SLALOM_SHUFFLE(row[2], row[3], 0, 8, 1, 9, 4, 12, 5, 13);
    const F t3 = SLALOM_SHUFFLE(row[2], row[3], 2, 10, 3, 11, 6, 14, 7, 15);
    r0 = SLALOM_SHUFFLE(t0, t2, 0, 1, 8, 9, 4, 5, 12, 13);
    r1 = SLALOM_SHUFFLE(t0, t2, 2, 3, 10, 11, 6, 7, 14, 15);
    r2 = SLALOM_SHUFFLE(t1, t3, 0, 1, 8, 9, 4, 5, 12, 13);
    r3 = SLALOM_SHUFFLE(t1, t3, 2, 3, 10, 11, 6, 7, 14, 15);
  }
};

template <>
struct Operations<Avx512> : PortableOperations<Avx512> {
  static constexpr __mmask16 all = 0xffff;  // the unmasked forms trip a false warning of g++ 12

  SLALOM_ISA_AVX512 static void min(const F& a, const F& b, F& r) {
    r = (F)_mm512_maskz_min_ps(all, (__m512)a, (__m512)b);
  }
  SLALOM_ISA_AVX512 static void max(const F& a, const F& b, F& r) {
    r = (F)_mm512_maskz_max_ps(all, (__m512)a, (__m512)b);
  }
  SLALOM_ISA_AVX512 static void subtract_product(const F& a, const F& b, const F& c, F& r) {
    r = (F)_mm512_fnmadd_ps((__m512)b, (__m512)c, (__m512)a);
  }
  SLALOM_ISA_AVX512 static void less(const F& a, const F& b, std::uint16_t& r) {
    r = _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
  }
  SLALOM_ISA_AVX512 static void less_or_equal(const F& a, const F& b, std::uint16_t& r) {
    r = _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LE_OQ);
  }
  SLALOM_ISA_AVX512 static void less(const I& a, const I& b, std::uint16_t& r) {
    r = _mm512_cmplt_epi32_mask((__m512i)a, (__m512i)b);
  }
  SLALOM_ISA_AVX512 static void equal(const I& a, const I& b, std::uint16_t& r) {
    r = _mm512_cmpeq_epi32_mask((__m512i)a, (__m512i)b);
  }
  static bool any(const std::uint16_t& mask) { return mask != 0; }
  SLALOM_ISA_AVX512 static void select(const std::uint16_t& condition, const F& a, const F& b, F& r) {
    r = (F)_mm512_mask_blend_ps(condition, (__m512)b, (__m512)a);
  }
  SLALOM_ISA_AVX512 static void store_mask(const std::uint16_t& mask, std::uint8_t* to) {
    constexpr std::uint64_t ones = 0x0101010101010101u;
    const std::uint64_t low = _pdep_u64(mask, ones), high = _pdep_u64(mask >> 8, ones);
    std::memcpy(to, &low, sizeof low);
    std::memcpy(to + 8, &high, sizeof high);
  }
  SLALOM_ISA_AVX512 static void sqrt(const F& a, F& r) { r = (F)_mm512_maskz_sqrt_ps(all, (__m512)a); }
  SLALOM_ISA_AVX512 static void reciprocal_sqrt(const F& a, F& r) {
    const F e = (F)_mm512_maskz_rsqrt14_ps(all, (__m512)a);
    r = e * (1.5f - 0.5f * a * e * e);
  }
  SLALOM_ISA_AVX512 static void round(const F& a, F& r) {
    r = (F)_mm512_maskz_roundscale_ps(all, (__m512)a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
  }
  SLALOM_ISA_AVX512 static void shift_left(I& a, int count) {
    a = (I)_mm512_maskz_sllv_epi32(all, (__m512i)a, _mm512_set1_epi32(count));
  }
  SLALOM_ISA_AVX512 static void reverse_bytes(I& a) {
    const __m512i order = _mm512_maskz_broadcast_i32x4(all, detail::reversed_bytes);
    a = (I)_mm512_maskz_shuffle_epi8(~__mmask64{0}, (__m512i)a, order);
  }
  SLALOM_ISA_AVX512 static void gather(const float* from, const I& index, F& r) {
    r = (F)_mm512_mask_i32gather_ps(_mm512_setzero_ps(), all, (__m512i)index, from, 4);
  }
  SLALOM_ISA_AVX512 static void gather(const std::int16_t* from, const I& index, I& r) {
    const __m512i both = _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), all, (__m512i)index,
                                                     reinterpret_cast<const int*>(from), 2);
    r = (I)_mm512_maskz_srai_epi32(all, _mm512_maskz_slli_epi32(all, both, 16), 16);
  }
  /// Four 128-bit loads a register, then a 4 x 4 transpose in every 128-bit block.
  SLALOM_ISA_AVX512 static void gather_cells(const float* from, const I& index, F& r0, F& r1, F& r2, F& r3) {
    // Stored in halves: a store of 512 bits is forwarded slowly to loads of single values.
    alignas(64) std::int32_t at[16];
    const __m512i scaled = (__m512i)(index << 2);
    _mm256_store_si256(reinterpret_cast<__m256i*>(at), _mm512_maskz_extracti64x4_epi64(0xff, scaled, 0));
    _mm256_store_si256(reinterpret_cast<__m256i*>(at + 8), _mm512_maskz_extracti64x4_epi64(0xff, scaled, 1));
    __asm__("" : "+m"(at));  // otherwise g++ extracts each lane from the register, which is slower
    F row[4];
    for (int k = 0; k < 4; ++k) {
      __m512 v = _mm512_zextps128_ps512(_mm_loadu_ps(from + at[k]));
      v = _mm512_maskz_insertf32x4(all, v, _mm_loadu_ps(from + at[k + 4]), 1);
      v = _mm512_maskz_insertf32x4(all, v, _mm_loadu_ps(from + at[k + 8]), 2);
      row[k] = (F)_mm512_maskz_insertf32x4(all, v, _mm_loadu_ps(from + at[k + 12]), 3);
    }
    const F t0 = SLALOM_SHUFFLE(row[0], row[1], 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
    const F t1 = SLALOM_SHUFFLE(row[0], row[1], 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
    const F t2 = SLALOM_SHUFFLE(row[2], row[3], 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
    const F t3 = SLALOM_SHUFFLE(row[2], row[3], 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
    r0 = SLALOM_SHUFFLE(t0, t2, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29);
    r1 = SLALOM_SHUFFLE(t0, t2, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
    r2 = SLALOM_SHUFFLE(t1, t3, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29);
    r3 = SLALOM_SHUFFLE(t1, t3, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
  }
};
#undef SLALOM_SHUFFLE
#endif

template <class T>
struct Operations<Unfused<T>> : Operations<T> {};

}  // namespace slalom::simd
