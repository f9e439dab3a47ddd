#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::vehicle::detail {

/// Sums of weight over occupied bins of (x, y, yaw): a hash table of fixed size, cleared in constant time.
class PoseBins {
 public:
  /// Room for `most` occupied bins.
  PoseBins(int most, double size, double angle)
      : slots_(std::bit_ceil(static_cast<std::size_t>(2 * most))),
        per_meter_(1 / size),
        per_radian_(1 / angle) {}

  void clear() noexcept {
    ++generation_;
    occupied_ = 0;
    heaviest_ = 0;
  }

  /// Adds to the bin of a pose (m, rad in [-pi, pi]); whether it was empty before.
  bool add(double x, double y, double yaw, double weight) noexcept {
    const std::uint64_t key = key_of(x, y, yaw);
    // The finaliser of MurmurHash3 (A. Appleby), which mixes all bits into all others.
    std::uint64_t hash = key;
    hash = (hash ^ (hash >> 33)) * 0xff51afd7ed558ccdu;
    hash = (hash ^ (hash >> 33)) * 0xc4ceb9fe1a85ec53u;
    hash ^= hash >> 33;
    for (std::size_t i = hash & (slots_.size() - 1);; i = (i + 1) & (slots_.size() - 1)) {
      Slot& slot = slots_[i];
      const bool empty = slot.generation != generation_;
      if (!empty && slot.key != key) continue;
      slot = {key, generation_, (empty ? 0 : slot.weight) + weight};
      if (slot.weight > heaviest_) {
        heaviest_ = slot.weight;
        heaviest_key_ = key;
      }
      occupied_ += empty;
      return empty;
    }
  }

  int occupied() const noexcept { return occupied_; }

  /// Whether a pose lies in the heaviest bin.
  bool in_heaviest(double x, double y, double yaw) const noexcept {
    return key_of(x, y, yaw) == heaviest_key_;
  }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint64_t generation = 0;
    double weight = 0;
  };
  std::uint64_t key_of(double x, double y, double yaw) const noexcept {
    return (bin(x, per_meter_) << 42) ^ (bin(y, per_meter_) << 21) ^ bin(yaw, per_radian_);
  }
  static std::uint64_t bin(double value, double scale) noexcept {
    return static_cast<std::uint64_t>(saturate_cast<std::int64_t>(std::floor(value * scale) + (1 << 20))) &
           0x1fffff;
  }

  std::vector<Slot> slots_;
  double per_meter_, per_radian_;
  std::uint64_t generation_ = 1, heaviest_key_ = 0;
  double heaviest_ = 0;
  int occupied_ = 0;
};

/// Particles that suffice for `occupied` bins, so that the Kullback-Leibler divergence between the particles
/// and the posterior stays below `error` with the probability of which `quantile` is the normal quantile: Fox
/// 2003, eq. 7 (Wilson & Hilferty's approximation of the chi-square quantile).
inline double kld_sample_size(int occupied, double error, double quantile) noexcept {
  if (occupied < 2) return 1;
  const double freedom = occupied - 1, spread = 2 / (9 * freedom);
  const double root = 1 - spread + std::sqrt(spread) * quantile;
  return freedom / (2 * error) * root * root * root;
}

}  // namespace slalom::vehicle::detail
