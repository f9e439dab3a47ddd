#pragma once

#include <cstdint>
#include <span>

namespace slalom::sim {

/// A stream of normal noise of its own for each (seed, car): call n yields the same values whatever was
/// called before, on every machine and instruction set.
///
/// 32 random bits by a counter and two rounds of a multiply-and-shift hash, then the transform of Box &
/// Muller (1958) with the polynomials below; the tails reach 6.6 standard deviations.
class NormalNoise {
 public:
  NormalNoise() = default;
  NormalNoise(std::uint64_t seed, std::uint64_t car) noexcept;

  /// Adds noise of the given standard deviation to each range, and cuts it to [0, most]. Ranges of `most`
  /// have no return to be noisy; a `dropout` share of the others is lost and becomes `most`.
  void add(std::span<double> ranges, double deviation, double most, double dropout) noexcept;

 private:
  std::uint64_t key_ = 0;
  std::uint64_t count_ = 0;
};

}  // namespace slalom::sim
