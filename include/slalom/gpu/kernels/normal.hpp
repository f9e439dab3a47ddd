#pragma once

#include <bit>

#include "slalom/core/random.hpp"
#include "slalom/gpu/kernels/block.hpp"

/// The random numbers of `slalom::fill_normal` (core/random.hpp). Uniform words are equal to the processor's,
/// normal values but for roundings.
namespace slalom::gpu {

using Key = std::array<std::uint32_t, 4>;
inline Key key_of(unsigned long long seed, unsigned long long stream) {
  return {unsigned(seed), unsigned(seed >> 32), unsigned(stream), unsigned(stream >> 32) ^ 0xba7c4000u};
}

/// Two normal values from a random word (Box and Muller); the coefficients are those of core/normal_pair.hpp.
inline void normal_pair(unsigned word, float& first, float& second) {
  const int bits = int(word >> 1);
  const float uniform = float(bits) * 0x1p-31f + 0x1p-32f;
  const int b = std::bit_cast<int>(uniform), e = (b - 0x3f3504f3) >> 23;
  const float m = std::bit_cast<float>(b - (e << 23)) - 1.0f;
  float p = -0.24422094f;
  p = p * m + 0.37565732f;
  p = p * m + -0.40909559f;
  p = p * m + 0.4979356f;
  p = p * m + -0.66632055f;
  p = p * m + 1.00002797f;
  p = p * m + -2.00000176f;
  float squared = p * m + float(e) * -1.38629436f;
  squared = squared > 1e-14f ? squared : 1e-14f;
  const float radius = squared * Block::reciprocal_sqrt(squared);
  const float angle = float(int(Block::reverse_bytes(unsigned(bits)))) * 0x1p-31f, x2 = angle * angle;
  const float sine = angle * (1.57079101f + x2 * (-0.64589285f + x2 * (0.07943434f + x2 * -0.0043331f)));
  const float cosine =
      0.999999953f + x2 * (-1.23369821f + x2 * (0.253650745f + x2 * (-0.0208106275f + x2 * 0.000858190620f)));
  const float signed_radius = std::bit_cast<float>(std::bit_cast<int>(radius) ^ int(word << 31));
  first = signed_radius * cosine;
  second = signed_radius * sine;
}

/// Eight normal values: rows 8 octet ... 8 octet + 7 of a sample.
inline void normal_octet(const Key& key, int sample, int octet, float (&z)[8]) {
  const auto words = detail::threefry(unsigned(sample), unsigned(octet), 0u, 0u, key);
  SLALOM_UNROLLED()
  for (int j = 0; j < 4; ++j) normal_pair(words[j], z[2 * j], z[2 * j + 1]);
}

/// Fills v[row * stride + k] with make(row, z), z normal, for the samples first + k, k < 2^count_log2. The
/// first `busy` threads of the block take no part.
template <class Make>
void draw(const Key& key, int rows, int first, int count_log2, int stride, float* v, int busy, Make&& make) {
  const int octets = (rows + 7) / 8, count = 1 << count_log2;
  if (Block::thread() < busy) return;
  for (int i = Block::thread() - busy; i < octets << count_log2; i += Block::threads() - busy) {
    const int octet = i >> count_log2, k = i & (count - 1);
    float z[8];
    normal_octet(key, first + k, octet, z);
    SLALOM_UNROLLED()
    for (int j = 0; j < 8; ++j)
      if (8 * octet + j < rows) v[(8 * octet + j) * stride + k] = make(8 * octet + j, z[j]);
  }
}

}  // namespace slalom::gpu
