#pragma once

#include <cstdint>
#include <span>

namespace slalom::sim {

/// A stream of normal noise for each (seed, car). The values of call n do not depend on other streams, and
/// are the same on every machine and instruction set.
///
/// Random bits by a counter and two rounds of a multiply-and-shift hash, then the transform of Box & Muller
/// (1958) in float32; the tails reach 5.9 standard deviations.
class NormalNoise {
 public:
  /// The stream of one car of one run.
  void reset(std::uint64_t seed, std::uint64_t car) noexcept;

  /// Adds noise of the given standard deviation (m) to the first `count` ranges and cuts them to [0, most].
  /// Ranges of `most` have no return to be noisy; a `dropout` share of the others is lost and becomes `most`.
  /// The array has Lidar::padded_beams() values.
  void add(std::span<float> ranges, int count, double deviation, double most, double dropout);

 private:
  std::uint64_t key_ = 0;
  std::uint64_t count_ = 0;
};

}  // namespace slalom::sim
