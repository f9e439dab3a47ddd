#pragma once

#include "slalom/sim/car.hpp"
#include "slalom/sim/lidar.hpp"

/// Random numbers and collisions with walls as f1tenth_gym has them.
namespace slalom::sim {

/// The draws of numpy.random.default_rng(seed), bit for bit, as far as f1tenth_gym uses them.
///
/// Seeding: SeedSequence after M. E. O'Neill, "Developing a seed_seq Alternative" (2015), with a pool of 4
/// words. Stream: PCG64, the generator PCG XSL RR 128/64 of O'Neill, "PCG: A Family of Simple Fast
/// Space-Efficient Statistically Good Algorithms for Random Number Generation", HMC-CS-2014-0905. Whole
/// numbers: D. Lemire, "Fast Random Integer Generation in an Interval" (2019), over 32 bit. Normal numbers:
/// the ziggurat of Marsaglia & Tsang (2000) with 256 layers.
class NumpyRandom {
 public:
  /// Same numbers as `numpy.random.default_rng(seed)`.
  explicit NumpyRandom(std::uint64_t seed) noexcept;

  std::uint64_t bits() noexcept;  ///< the next 64 bits of the stream

  /// A whole number in [0, count), count >= 1: Generator.integers(count), and the index of Generator.choice.
  std::uint32_t below(std::uint32_t count) noexcept;

  double uniform(double low, double high) noexcept;  ///< Generator.uniform(low, high)

  double normal() noexcept;  ///< Generator.normal(0, 1)

  /// SeedSequence(seed).generate_state(4, uint64).
  static std::array<std::uint64_t, 4> seed_state(std::uint64_t seed) noexcept;

 private:
  __extension__ using Wide = unsigned __int128;

  void advance() noexcept;
  double unit() noexcept { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  std::uint32_t half() noexcept;

  Wide state_ = 0;
  Wide increment_ = 0;
  std::uint32_t kept_half_ = 0;  ///< upper half of a number whose lower half was used
  bool has_half_ = false;
};

/// f1tenth_gym's test for a wall hit: at the present speed, the car would cover the range of a beam, less the
/// distance to the car's outline, in less than 5 ms. The outline is assumed (l_f + l_r) / 2 ahead and behind
/// instead of half a length, ranges within it ahead of the car do not count, and a fast car moves further in
/// a step than the test covers. Track::collides_with_wall computes exact collisions.
class TimeToCollision {
 public:
  TimeToCollision(const LidarOptions& lidar, const CarParameters& car);  ///< computed for a scanner on a car

  /// The first beam with a time to collision below the limit, -1 if there is none.
  int first_hit(std::span<const double> ranges, double speed) const noexcept;

  /// The way (m) from the centre of gravity to the car's outline, one per beam.
  std::span<const double> sides() const noexcept { return sides_; }
  std::span<const double> cosines() const noexcept { return cosines_; }  ///< cosines of the beam angles

 private:
  std::vector<double> cosines_, sides_;
};

}  // namespace slalom::sim
