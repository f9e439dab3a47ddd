#include "slalom/sim/noise.hpp"

#include <algorithm>

#include "sim/lidar/scan.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::sim {
namespace {

/// The finaliser of SplitMix64 (Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ x >> 27) * 0x94d049bb133111ebull;
  return x ^ x >> 31;
}

}  // namespace

void NormalNoise::reset(std::uint64_t seed, std::uint64_t car) noexcept {
  key_ = scramble(scramble(seed + 0x9e3779b97f4a7c15ull) + car);
  count_ = 0;
}

void NormalNoise::add(std::span<float> ranges, int count, double deviation, double most, double dropout) {
  const std::uint64_t now = scramble(key_ + 0x9e3779b97f4a7c15ull * ++count_);
  const detail::NoiseTask task{
      .key0 = static_cast<std::uint32_t>(now),
      .key1 = static_cast<std::uint32_t>(now >> 32),
      .deviation = static_cast<float>(deviation),
      .most = static_cast<float>(most),
      .lost_below = saturate_cast<std::uint32_t>(std::min(dropout * 0x1p32, 0x1p32 - 1)),
      .count = count,
      .ranges = ranges.data()};
  detail::scan_kernels().noise(task);
}

}  // namespace slalom::sim
