#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "localiser_particles.hpp"

namespace slalom::vehicle::detail {

/// Hypotheses of other places where the car may be. Each one is tracked separately, by the best of a few
/// disturbed copies, and they compete by their fit over some time: within one set of particles the first
/// place that fits well would soon displace all others (the reason for clusters in Milstein, Sanchez &
/// Williamson, "Robust global localization using clustered particle filtering", AAAI 2002). In every update
/// poses from all of the free space are weighted, and the best become hypotheses.
class Search {
 public:
  explicit Search(std::shared_ptr<const FreeCells> free_cells)
      : free_cells_(std::move(free_cells)),
        poses_(1, 3, max_hypotheses * (copies + search_factor)),
        noise_(1, 3, max_hypotheses * copies),
        log_fit_(poses_.stride()),
        hypotheses_(max_hypotheses),
        newcomers_(newcomers) {}

  struct Hypothesis {
    maps::Pose pose;     ///< grid's frame
    double log_fit = 0;  ///< mean over beams, averaged over time once it is mature
    int age = 0;         ///< updates
  };

  void clear() noexcept { count_ = 0; }

  /// Moves, weights and selects. `memory` in [0, 1) is the share of the averaged fit that is kept.
  void update(const maps::Pose& step, const SensorTables& sensor, const ScanBeams& beams, double memory,
              RandomKey key) noexcept {
    for (int h = 0; h < count_; ++h) {
      maps::Pose& pose = hypotheses_[h].pose;
      const maps::Point moved = maps::transform(pose, {step.x, step.y});
      pose = {moved.x, moved.y, maps::wrap_angle(pose.yaw + step.yaw)};
    }
    place_copies(key);
    place_random(key);
    sensor.weigh_by_field(poses_of(poses_, poses_.stride()), beams, log_fit_.data());
    const int first_random = count_ * copies;
    take_best_copies(memory);
    drop_twins();
    admit(first_random);
  }

  /// The best mature hypothesis; null if none is.
  const Hypothesis* best() const noexcept {
    const Hypothesis* found = nullptr;
    for (int h = 0; h < count_; ++h) {
      const Hypothesis& other = hypotheses_[h];
      if (other.age > young && (!found || other.log_fit > found->log_fit)) found = &other;
    }
    return found;
  }

  /// The mean over beams of the log of the fit at one pose.
  double log_fit_at(const maps::Pose& pose, const SensorTables& sensor, const ScanBeams& beams) noexcept {
    for (int i = 0; i < simd::padding; ++i) put(i, pose);
    sensor.weigh_by_field(poses_of(poses_, simd::padding), beams, log_fit_.data());
    return static_cast<double>(log_fit_[0]);
  }

  /// Whether the sensor model of the options also prefers `other` to `place`. That of beams does not count a
  /// reading that ends before a wall, at a car that is not in the map, as much as one that passes through it.
  bool confirms(const maps::Pose& other, const maps::Pose& place, const SensorTables& sensor,
                const ScanBeams& beams) noexcept {
    for (int i = 0; i < simd::padding; ++i) put(i, i == 0 ? other : place);
    sensor.weigh(poses_of(poses_, simd::padding), beams, log_fit_.data());
    return log_fit_[0] > log_fit_[1];
  }

 private:
  static constexpr int max_hypotheses = 96;
  static constexpr int search_factor = 28;                    ///< random poses per hypothesis in each update
  static constexpr int copies = 12;                           ///< copies of a hypothesis, itself included
  static constexpr int young = 6;                             ///< updates: not yet to be compared with others
  static constexpr int newcomers = 8;                         ///< in an update
  static constexpr double same_place = 0.35, same_yaw = 0.3;  ///< m, rad
  static constexpr double young_jitter = 0.2, young_yaw_jitter = 0.1;    ///< m, rad
  static constexpr double grown_jitter = 0.08, grown_yaw_jitter = 0.04;  ///< m, rad

  static bool same(const maps::Pose& a, const maps::Pose& b) {
    const double dx = a.x - b.x, dy = a.y - b.y;
    return dx * dx + dy * dy < same_place * same_place &&
           std::abs(maps::wrap_angle(a.yaw - b.yaw)) < same_yaw;
  }

  /// The hypotheses and disturbed copies of them at the front of the batch.
  void place_copies(RandomKey key) noexcept {
    fill_normal(noise_, 0, padded(count_ * copies), key);
    for (int h = 0, i = 0; h < count_; ++h) {
      const Hypothesis& from = hypotheses_[h];
      const double jitter = from.age < young ? young_jitter : grown_jitter;
      const double yaw_jitter = from.age < young ? young_yaw_jitter : grown_yaw_jitter;
      put(i++, from.pose);
      for (int k = 1; k < copies; ++k, ++i)
        put(i, {from.pose.x + jitter * noise_.at(0, 0, i), from.pose.y + jitter * noise_.at(0, 1, i),
                maps::wrap_angle(from.pose.yaw + yaw_jitter * noise_.at(0, 2, i))});
    }
  }

  void place_random(RandomKey key) noexcept {
    RandomStream random(key);
    for (int i = count_ * copies; i < poses_.samples(); ++i) put(i, free_cells_->random_pose(random));
  }

  void take_best_copies(double memory) noexcept {
    for (int h = 0; h < count_; ++h) {
      const float* fits = log_fit_.data() + h * copies;
      const int best = static_cast<int>(std::max_element(fits, fits + copies) - fits);
      Hypothesis& to = hypotheses_[h];
      to.pose = batch_pose(h * copies + best);
      const double fit = static_cast<double>(fits[best]);
      to.log_fit = to.age <= young ? fit : memory * to.log_fit + (1 - memory) * fit;
      ++to.age;
    }
  }

  /// Drops the worse of two hypotheses about the same place.
  void drop_twins() noexcept {
    for (int a = 0; a < count_; ++a) {
      Hypothesis& first = hypotheses_[a];
      for (int b = count_ - 1; b > a; --b) {
        Hypothesis& second = hypotheses_[b];
        if (!same(first.pose, second.pose)) continue;
        const int age = std::max(first.age, second.age);
        if (second.log_fit > first.log_fit) first = second;
        first.age = age;
        second = hypotheses_[--count_];
      }
    }
  }

  /// Makes the best poses from `first` on hypotheses, in the place of the worst grown-up ones.
  void admit(int first) noexcept {
    int chosen = 0;
    for (int i = first; i < poses_.samples(); ++i) {
      const float fit = log_fit_[i];
      const auto worse = [&](int other) { return log_fit_[other] < fit; };
      if (chosen == newcomers && !worse(newcomers_[newcomers - 1])) continue;
      if (chosen < newcomers) ++chosen;
      int at = chosen - 1;
      for (; at > 0 && worse(newcomers_[at - 1]); --at) newcomers_[at] = newcomers_[at - 1];
      newcomers_[at] = i;
    }
    for (int n = 0; n < chosen; ++n) {
      const int from = newcomers_[n];
      int to = count_;
      if (count_ < max_hypotheses) {
        ++count_;
      } else {
        to = -1;
        for (int h = 0; h < count_; ++h) {
          const Hypothesis& old = hypotheses_[h];
          if (old.age > young && (to < 0 || old.log_fit < hypotheses_[to].log_fit)) to = h;
        }
        if (to < 0) return;
      }
      hypotheses_[to] = {batch_pose(from), static_cast<double>(log_fit_[from]), 1};
    }
  }

  maps::Pose batch_pose(int i) const noexcept {
    return {poses_.at(0, 0, i), poses_.at(0, 1, i), poses_.at(0, 2, i)};
  }

  void put(int i, const maps::Pose& pose) noexcept { put_pose(poses_, i, pose); }

  std::shared_ptr<const FreeCells> free_cells_;
  SequenceBatch poses_, noise_;  ///< [1][x, y, yaw][pose]
  AlignedBuffer log_fit_;
  std::vector<Hypothesis> hypotheses_;
  std::vector<int> newcomers_;
  int count_ = 0;  ///< number of hypotheses
};

}  // namespace slalom::vehicle::detail
