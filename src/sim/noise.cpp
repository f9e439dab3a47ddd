#include "slalom/sim/noise.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::sim {
namespace {

/// The finaliser of SplitMix64 (Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ x >> 27) * 0x94d049bb133111ebull;
  return x ^ x >> 31;
}

std::uint32_t hash(std::uint32_t x) {
  x = (x ^ x >> 16) * 0x7feb352du;
  x = (x ^ x >> 15) * 0x846ca68bu;
  return x ^ x >> 16;
}

}  // namespace

NormalNoise::NormalNoise(std::uint64_t seed, std::uint64_t car) noexcept
    : key_(scramble(scramble(seed + 0x9e3779b97f4a7c15ull) + car)) {}

void NormalNoise::add(std::span<double> ranges, double deviation, double most, double dropout) noexcept {
  const std::uint64_t now = scramble(key_ + 0x9e3779b97f4a7c15ull * ++count_);
  const auto low = static_cast<std::uint32_t>(now), high = static_cast<std::uint32_t>(now >> 32);
  const auto lost_below = static_cast<std::uint32_t>(std::min(dropout * 0x1p32, 0x1p32 - 1));
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (ranges[i] >= most) continue;
    const std::uint32_t a = hash(hash(static_cast<std::uint32_t>(i) ^ low) ^ high),
                        b = hash(a ^ 0x9e3779b9u ^ low);
    const double radius = std::sqrt(-2 * std::log((a + 1.0) * 0x1p-32));
    ranges[i] =
        std::clamp(ranges[i] + deviation * radius * std::cos(6.283185307179586 * b * 0x1p-32), 0.0, most);
    if (dropout > 0 && hash(b ^ high) <= lost_below) ranges[i] = most;
  }
}

}  // namespace slalom::sim
