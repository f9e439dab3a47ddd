#pragma once

#include <array>
#include <cmath>
#include <utility>

#include "slalom/core/sequence_batch.hpp"

namespace slalom {

/// Identifies a stream of random numbers. The same key gives the same numbers, in any order and on any number
/// of threads.
struct RandomKey {
  std::uint64_t seed = 0;    ///< seed of the random numbers
  std::uint64_t stream = 0;  ///< for instance made of the numbers of a solve and a stage
};

namespace detail {

/// Returns four random words for a counter of four words and a key: Threefry-4x32 with 12 rounds, which
/// passes all tests of BigCrush (Salmon et al., "Parallel Random Numbers: As Easy as 1, 2, 3", SC 2011).
/// `Word` is a 32-bit unsigned integer or a vector of them.
template <class Word>
inline std::array<Word, 4> threefry(Word x0, Word x1, Word x2, Word x3,
                                    const std::array<std::uint32_t, 4>& key) {
  constexpr int rounds = 12;
  constexpr int rotation[8][2] = {{10, 26}, {11, 21}, {13, 27}, {23, 5},
                                  {6, 20},  {17, 11}, {25, 10}, {18, 20}};
  const std::uint32_t schedule[5] = {key[0], key[1], key[2], key[3],
                                     0x1BD11BDAu ^ key[0] ^ key[1] ^ key[2] ^ key[3]};
  const auto mix = [](Word& a, Word& b, int r) {
    a = a + b;
    b = ((b << r) | (b >> (32 - r))) ^ a;
  };
  x0 = x0 + schedule[0];
  x1 = x1 + schedule[1];
  x2 = x2 + schedule[2];
  x3 = x3 + schedule[3];
  for (int round = 0; round < rounds; round += 4) {
    mix(x0, x1, rotation[round % 8][0]);
    mix(x2, x3, rotation[round % 8][1]);
    mix(x0, x3, rotation[round % 8 + 1][0]);
    mix(x2, x1, rotation[round % 8 + 1][1]);
    mix(x0, x1, rotation[round % 8 + 2][0]);
    mix(x2, x3, rotation[round % 8 + 2][1]);
    mix(x0, x3, rotation[round % 8 + 3][0]);
    mix(x2, x1, rotation[round % 8 + 3][1]);
    const std::uint32_t injection = static_cast<std::uint32_t>(round / 4 + 1);
    x0 = x0 + schedule[injection % 5];
    x1 = x1 + schedule[(injection + 1) % 5];
    x2 = x2 + schedule[(injection + 2) % 5];
    x3 = x3 + (schedule[(injection + 3) % 5] + injection);
  }
  return {x0, x1, x2, x3};
}

}  // namespace detail

/// Draws random numbers one at a time. Satisfies the concept std::uniform_random_bit_generator. For batches
/// of samples see `fill_normal`.
class RandomStream {
 public:
  using result_type = std::uint32_t;  ///< type of the numbers

  /// Starts at the first number of `key`. A mirrored stream is antithetic: it gives 1 - u and -z where the
  /// plain one gives the uniform value u and the normal value z.
  explicit RandomStream(RandomKey key, bool mirrored = false) noexcept : key_(key), mirrored_(mirrored) {}

  /// Smallest value.
  static constexpr result_type min() { return 0; }
  /// The largest value.
  static constexpr result_type max() { return 0xffffffffu; }

  /// 32 random bits.
  result_type operator()() noexcept { return mirrored_ ? ~next() : next(); }
  /// Uniform in [0, 1), 53 bits.
  double uniform() noexcept {
    const std::uint64_t high = (*this)() >> 5, low = (*this)() >> 6;
    return static_cast<double>(high * 67108864u + low) * 0x1p-53;
  }
  /// Uniform in [low, high).
  double uniform(double low, double high) noexcept { return low + (high - low) * uniform(); }
  /// Standard normal (Box & Muller 1958).
  double normal() noexcept {
    const bool mirrored = std::exchange(mirrored_, false);
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    const double value = radius * std::cos(6.283185307179586 * uniform());
    mirrored_ = mirrored;
    return mirrored ? -value : value;
  }

 private:
  result_type next() noexcept {
    if (used_ == 4) refill();
    return words_[static_cast<std::size_t>(used_++)];
  }
  void refill() noexcept;

  RandomKey key_;
  bool mirrored_;
  std::uint64_t block_ = 0;
  std::array<std::uint32_t, 4> words_ = {};
  int used_ = 4;
};

/// Fills the samples `first` ... `first + count - 1` (and the padding after them) of every row of `batch`
/// with standard normal values. `first` is a multiple of `simd::padding`. A value depends only on the key,
/// its row and its sample index. The largest magnitude is 6.6.
void fill_normal(SequenceBatch& batch, int first, int count, RandomKey key) noexcept;

}  // namespace slalom
