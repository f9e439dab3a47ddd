#pragma once

#include <bit>

#include "slalom/gpu/kernels/block.hpp"

/// The random numbers of `slalom::fill_normal` (core/random.hpp): Threefry-4x32 with 12 rounds, then pairs of
/// normal values. Uniform words are equal to the processor's, normal values but for roundings.
namespace slalom::gpu {

struct Key {
  unsigned schedule[5];
};
inline Key key_of(unsigned long long seed, unsigned long long stream) {
  const unsigned a = unsigned(seed), b = unsigned(seed >> 32), c = unsigned(stream),
                 d = unsigned(stream >> 32) ^ 0xba7c4000u;
  return {{a, b, c, d, 0x1BD11BDAu ^ a ^ b ^ c ^ d}};
}

/// Four random words for the counter (x0, x1).
inline void threefry(unsigned x0, unsigned x1, const Key& key, unsigned (&out)[4]) {
  constexpr int rotation[8][2] = {{10, 26}, {11, 21}, {13, 27}, {23, 5},
                                  {6, 20},  {17, 11}, {25, 10}, {18, 20}};
  unsigned x2 = key.schedule[2], x3 = key.schedule[3];
  x0 += key.schedule[0];
  x1 += key.schedule[1];
  SLALOM_UNROLL_ALL
  for (int round = 0; round < 12; ++round) {
    const int r0 = rotation[round % 8][0], r1 = rotation[round % 8][1];
    if (round % 2 == 0) {
      x0 += x1, x1 = std::rotl(x1, r0) ^ x0;
      x2 += x3, x3 = std::rotl(x3, r1) ^ x2;
    } else {
      x0 += x3, x3 = std::rotl(x3, r0) ^ x0;
      x2 += x1, x1 = std::rotl(x1, r1) ^ x2;
    }
    if (round % 4 == 3) {
      const int i = round / 4 + 1;
      x0 += key.schedule[i % 5], x1 += key.schedule[(i + 1) % 5], x2 += key.schedule[(i + 2) % 5],
          x3 += key.schedule[(i + 3) % 5] + unsigned(i);
    }
  }
  out[0] = x0, out[1] = x1, out[2] = x2, out[3] = x3;
}

/// Two normal values from a random word (Box and Muller); the coefficients are those of core/pack/normal.hpp.
inline void normal_pair(unsigned word, float& first, float& second) {
  const int bits = int(word >> 1);
  const float uniform = float(bits) * 0x1p-31f + 0x1p-32f;
#if SLALOM_ON_GPU
  const int reversed = int(__byte_perm(unsigned(bits), 0, 0x0123));
#else
  const int reversed = int(__builtin_bswap32(unsigned(bits)));
#endif
  const int b = std::bit_cast<int>(uniform), e = (b - 0x3f3504f3) >> 23;
  const float m = std::bit_cast<float>(b - (e << 23)) - 1.0f, n = float(e);
  float p = -0.24422094f;
  p = p * m + 0.37565732f;
  p = p * m + -0.40909559f;
  p = p * m + 0.4979356f;
  p = p * m + -0.66632055f;
  p = p * m + 1.00002797f;
  p = p * m + -2.00000176f;
  float squared = p * m + n * -1.38629436f;
  squared = squared > 1e-14f ? squared : 1e-14f;
#if SLALOM_ON_GPU
  const float radius = squared * rsqrtf(squared);
#else
  const float radius = std::sqrt(squared);
#endif
  const float angle = float(reversed) * 0x1p-31f, x2 = angle * angle;
  const float sine = angle * (1.57079101f + x2 * (-0.64589285f + x2 * (0.07943434f + x2 * -0.0043331f)));
  const float cosine =
      0.999999953f + x2 * (-1.23369821f + x2 * (0.253650745f + x2 * (-0.0208106275f + x2 * 0.000858190620f)));
  const float signed_radius = std::bit_cast<float>(std::bit_cast<int>(radius) ^ int(word << 31));
  first = signed_radius * cosine;
  second = signed_radius * sine;
}

/// Eight normal values: rows 8 octet ... 8 octet + 7 of a sample.
inline void normal_octet(const Key& key, int sample, int octet, float (&z)[8]) {
  unsigned words[4];
  threefry(unsigned(sample), unsigned(octet), key, words);
  SLALOM_UNROLL_ALL
  for (int j = 0; j < 4; ++j) normal_pair(words[j], z[2 * j], z[2 * j + 1]);
}

/// Fills v[row * stride + k] with make(row, z), z normal, for the samples first + k, k < 2^count_log2. The
/// first `busy` threads of the block take no part.
template <class Make>
void draw(const Key& key, int rows, int first, int count_log2, int stride, float* v, int busy, Make&& make) {
  const int octets = (rows + 7) / 8, count = 1 << count_log2;
#if SLALOM_ON_GPU
  const int begin = int(threadIdx.x) - busy, threads = int(blockDim.x) - busy;
  if (begin < 0) return;
#else
  const int begin = 0, threads = 1;
  static_cast<void>(busy);
#endif
  for (int i = begin; i < octets << count_log2; i += threads) {
    const int octet = i >> count_log2, k = i & (count - 1);
    float z[8];
    normal_octet(key, first + k, octet, z);
    float* to = v + 8 * octet * stride + k;
    SLALOM_UNROLL_ALL
    for (int j = 0; j < 8; ++j)
      if (8 * octet + j < rows) to[j * stride] = make(8 * octet + j, k, z[j]);
  }
}

}  // namespace slalom::gpu
