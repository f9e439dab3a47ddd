#include "vehicle/planner/feasible_speeds.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "slalom/core/gravity.hpp"
#include "slalom/vehicle/course/speed_profile.hpp"
#include "vehicle/course/speed_passes.hpp"

namespace slalom::vehicle::detail {

DrivingLimits driving_limits(const VehicleTraits& traits, double friction) {
  return {.grip = friction * gravity * traits.tyres.usable_grip,
          .acceleration = traits.max_acceleration,
          .braking = traits.max_deceleration,
          .braking_share = traits.tyres.braking_share,
          .delay = traits.tyres.seeks_lap_time ? 0 : traits.time_step,
          .lead = traits.tyres.seeks_lap_time ? traits.time_step : 0,
          .switch_speed = traits.tyres.switch_speed};
}

FeasibleSpeeds::FeasibleSpeeds(std::span<const maps::ReferencePoint> path,
                               std::span<const double> grip_shares) {
  std::vector<maps::Point> points;
  for (const maps::ReferencePoint& point : path) {
    points.push_back({point.x, point.y});
    own_.push_back(point.speed);
  }
  PathGeometry geometry = path_geometry(points);
  curvature_ = std::move(geometry.curvature);
  gap_ = std::move(geometry.step);
  if (!geometry.closed) gap_.back() = 0;
  for (double arc = 0; const double gap : gap_) {
    arc_.push_back(arc);
    arc += gap;
  }
  speed_ = own_;
  const double parts = static_cast<double>(grip_shares.size()), whole_way = arc_.back() + gap_.back();
  for (const double arc : arc_) {
    const double part = whole_way > 0 ? std::floor(parts * arc / whole_way) : 0;
    share_.push_back(parts > 0 ? grip_shares[static_cast<std::size_t>(std::min(part, parts - 1))] : 1);
  }
  profile_ = speed_;
}

void FeasibleSpeeds::update(const DrivingLimits& limits) noexcept {
  for (std::size_t i = 0; i < speed_.size(); ++i)
    speed_[i] = std::min({own_[i], limits.top_speed,
                          std::sqrt(limits.grip * share_[i] / std::max(std::abs(curvature_[i]), 1e-6))});
  const auto speed_up = [&](std::size_t from, std::size_t to, double gap) {
    const double power =
        limits.acceleration * std::min(1.0, limits.switch_speed / std::max(speed_[from], 0.1));
    limit(to, from, gap, std::min(power, grip_left(from, limits.grip)));
  };
  const auto brake = [&](std::size_t from, std::size_t to, double gap) {
    limit(to, from, gap, std::min(limits.braking, limits.braking_share * grip_left(from, limits.grip)));
  };
  for_each_piece(speed_, gap_, length() > 0, speed_up, brake);
  anticipate(limits.delay);
  look_ahead(limits.lead);
}

/// The acceleration (m/s^2) left to the tyres at a point, which share their force between it and turning.
double FeasibleSpeeds::grip_left(std::size_t i, double full_grip) const noexcept {
  const double turning = speed_[i] * speed_[i] * curvature_[i], grip = full_grip * share_[i];
  return std::sqrt(std::max(grip * grip - turning * turning, 0.0));
}

/// Limits the speed at `to` to that after `gap` (m) from `from` with this change of speed (m/s^2).
void FeasibleSpeeds::limit(std::size_t to, std::size_t from, double gap, double change) noexcept {
  speed_[to] = std::min(speed_[to], std::sqrt(speed_[from] * speed_[from] + 2 * change * gap));
}

/// Lowers each speed to the least one on the way that the car drives within its delay, so that a car that
/// follows late sees a limit earlier.
void FeasibleSpeeds::anticipate(double delay) noexcept {
  const std::size_t n = speed_.size();
  for (std::size_t i = 0; i < n; ++i) {
    double way = speed_[i] * delay;
    for (std::size_t k = i; way > 0 && gap_[k] > 0; way -= gap_[k], k = (k + 1) % n)
      speed_[i] = std::min(speed_[i], speed_[(k + 1) % n]);
  }
}

/// Replaces each speed by that of the place which a car reaches within `lead` (s). A step of a plan looks
/// up its limit where it begins, but it applies where it ends, or a car would leave a curve one step late.
void FeasibleSpeeds::look_ahead(double lead) noexcept {
  if (!(lead > 0)) return;
  const std::size_t n = speed_.size();
  profile_ = speed_;
  for (std::size_t i = 0; i < n; ++i) {
    double way = profile_[i] * lead;
    std::size_t k = i;
    for (; gap_[k] > 0 && way >= gap_[k]; k = (k + 1) % n) way -= gap_[k];
    const double share = gap_[k] > 0 ? way / gap_[k] : 0;
    speed_[i] = profile_[k] + share * (profile_[(k + 1) % n] - profile_[k]);
  }
}

}  // namespace slalom::vehicle::detail
