#include "slalom/sim/gym.hpp"

#include <algorithm>

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::sim {
namespace {

/// The hash of SeedSequence: its constant changes with every use.
struct Hash {
  std::uint32_t constant;
  std::uint32_t multiplier;

  std::uint32_t operator()(std::uint32_t value) {
    value ^= constant;
    constant *= multiplier;
    value *= constant;
    return value ^ value >> 16;
  }
};

std::uint32_t mix(std::uint32_t x, std::uint32_t y) {
  const std::uint32_t result = 0xca01f9ddu * x - 0x4973f715u * y;
  return result ^ result >> 16;
}

/// Layers of equal area under exp(-x^2 / 2), the first holding the tail beyond `tail`. `inside[i]` is the
/// part of layer i (of 2^52) that lies under the curve for sure.
struct Ziggurat {
  static constexpr int layers = 256;
  static constexpr double tail = 3.6541528853610088;
  static constexpr double scale = 0x1p52;

  std::array<std::uint64_t, layers> inside{};
  std::array<double, layers> width{};
  std::array<double, layers> height{};

  Ziggurat() {
    double right = tail;
    const double area = tail * density(tail) + std::sqrt(std::acos(0.0)) * std::erfc(tail / std::sqrt(2.0));
    const double foot = area / density(tail);
    inside[0] = saturate_cast<std::uint64_t>(right / foot * scale);
    inside[1] = 0;
    width[0] = foot / scale;
    width[layers - 1] = right / scale;
    height[0] = 1;
    height[layers - 1] = density(tail);
    for (int i = layers - 2; i >= 1; --i) {
      const double edge = std::sqrt(-2 * std::log(area / right + density(right)));
      inside[i + 1] = saturate_cast<std::uint64_t>(edge / right * scale);
      right = edge;
      height[i] = density(right);
      width[i] = right / scale;
    }
  }
  static double density(double x) { return std::exp(-0.5 * x * x); }
};

const Ziggurat& ziggurat() {
  static const Ziggurat table;
  return table;
}

}  // namespace

std::array<std::uint64_t, 4> NumpyRandom::seed_state(std::uint64_t seed) noexcept {
  const std::array<std::uint32_t, 4> entropy{static_cast<std::uint32_t>(seed),
                                             static_cast<std::uint32_t>(seed >> 32), 0, 0};
  std::array<std::uint32_t, 4> pool;
  Hash hash{0x43b0d7e5u, 0x931e8875u};
  for (std::size_t i = 0; i < 4; ++i) pool[i] = hash(entropy[i]);
  for (std::size_t from = 0; from < 4; ++from)
    for (std::size_t to = 0; to < 4; ++to)
      if (from != to) pool[to] = mix(pool[to], hash(pool[from]));
  Hash out{0x8b51f9ddu, 0x58f38dedu};
  std::array<std::uint64_t, 4> words{};
  for (std::size_t i = 0; i < 8; ++i)
    words[i / 2] |= static_cast<std::uint64_t>(out(pool[i % 4])) << (32 * (i % 2));
  return words;
}

NumpyRandom::NumpyRandom(std::uint64_t seed) noexcept {
  const auto words = seed_state(seed);
  const Wide start = static_cast<Wide>(words[0]) << 64 | words[1];
  increment_ = (static_cast<Wide>(words[2]) << 64 | words[3]) << 1 | 1;
  advance();
  state_ += start;
  advance();
}

void NumpyRandom::advance() noexcept {
  const Wide multiplier = static_cast<Wide>(2549297995355413924ull) << 64 | 4865540595714422341ull;
  state_ = state_ * multiplier + increment_;
}

std::uint64_t NumpyRandom::bits() noexcept {
  advance();
  const auto folded = static_cast<std::uint64_t>(state_ >> 64) ^ static_cast<std::uint64_t>(state_);
  const auto turn = static_cast<unsigned>(state_ >> 122);
  return folded >> turn | folded << (-turn & 63);
}

std::uint32_t NumpyRandom::half() noexcept {
  if (has_half_) {
    has_half_ = false;
    return kept_half_;
  }
  const std::uint64_t both = bits();
  kept_half_ = static_cast<std::uint32_t>(both >> 32);
  has_half_ = true;
  return static_cast<std::uint32_t>(both);
}

std::uint32_t NumpyRandom::below(std::uint32_t count) noexcept {
  if (count <= 1) return 0;  // numpy draws nothing where there is no choice
  std::uint64_t product = static_cast<std::uint64_t>(half()) * count;
  if (static_cast<std::uint32_t>(product) < count) {
    const std::uint32_t rejected = -count % count;
    while (static_cast<std::uint32_t>(product) < rejected)
      product = static_cast<std::uint64_t>(half()) * count;
  }
  return static_cast<std::uint32_t>(product >> 32);
}

// Here and not in the header, since this file forms no fused multiply-add.
double NumpyRandom::uniform(double low, double high) noexcept {
  return low + (high - low) * unit();
}

double NumpyRandom::normal() noexcept {
  const Ziggurat& table = ziggurat();
  while (true) {
    std::uint64_t drawn = bits();
    const auto layer = static_cast<std::size_t>(drawn & 0xff);
    drawn >>= 8;
    const bool negative = drawn & 1;
    const std::uint64_t along = (drawn >> 1) & 0x000fffffffffffffull;
    const double x = along * table.width[layer] * (negative ? -1 : 1);
    if (along < table.inside[layer]) return x;
    if (layer == 0) {
      while (true) {
        const double beyond = -std::log1p(-unit()) / Ziggurat::tail;
        const double y = -std::log1p(-unit());
        if (y + y > beyond * beyond) {
          const double value = Ziggurat::tail + beyond;
          return along >> 8 & 1 ? -value : value;
        }
      }
    }
    if ((table.height[layer - 1] - table.height[layer]) * unit() + table.height[layer] <
        std::exp(-0.5 * x * x))
      return x;
  }
}

TimeToCollision::TimeToCollision(const LidarOptions& lidar, const CarParameters& car) {
  constexpr double quarter = 1.5707963267948966;
  const double side = car.width / 2, front = (car.front_length + car.rear_length) / 2;
  for (int i = 0; i < lidar.beams; ++i) {
    const double angle = lidar.angle_min() + i * lidar.angle_increment(), turn = std::abs(angle);
    cosines_.push_back(std::cos(angle));
    sides_.push_back(turn < quarter
                         ? std::min(side / std::sin(turn), front / std::cos(turn))
                         : std::min(side / std::cos(turn - quarter), front / std::sin(turn - quarter)));
  }
}

int TimeToCollision::first_hit(std::span<const double> ranges, double speed) const noexcept {
  constexpr double soon = 0.005;  // s
  if (speed == 0) return -1;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const double time = (ranges[i] - sides_[i]) / (speed * cosines_[i]);
    if (time < soon && time >= 0) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace slalom::sim
