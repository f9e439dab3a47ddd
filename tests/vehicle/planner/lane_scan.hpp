#pragma once

#include <algorithm>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"
#include "solvers/closed_form.hpp"

namespace slalom::testing {

/// A wall from one point to another, m, in the frame of the car.
struct Wall {
  maps::Point from, to;
};

/// The readings of a laser 0.275 m ahead of the rear axle among walls; 29 m where none stands.
class LaneScan {
 public:
  /// The beams cover 4.7 rad from `first` (rad) on.
  explicit LaneScan(const std::vector<Wall>& walls, std::size_t beams = 271, double first = -2.35)
      : first_(first), step_(4.7 / (static_cast<double>(beams) - 1)), ranges_(beams) {
    for (std::size_t i = 0; i < beams; ++i) {
      const double angle = first + static_cast<double>(i) * step_, c = std::cos(angle), s = std::sin(angle);
      double range = 29;
      for (const Wall& wall : walls) {
        // laser + distance (c, s) = from + share along
        const maps::Point from{wall.from.x - 0.275, wall.from.y},
            along{wall.to.x - wall.from.x, wall.to.y - wall.from.y};
        const double determinant = c * along.y - s * along.x;
        const double distance = (from.x * along.y - from.y * along.x) / determinant;
        const double share = (from.x * s - from.y * c) / determinant;
        if (distance > 0 && share >= 0 && share <= 1) range = std::min(range, distance);
      }
      ranges_[i] = static_cast<float>(range);
    }
  }
  maps::LaserScanView view() const { return view_of(ranges_); }
  /// The same scan with other readings.
  maps::LaserScanView view_of(const std::vector<float>& ranges) const {
    return {ranges, first_, step_, 0.05, 30};
  }
  std::vector<float>& ranges() { return ranges_; }

 private:
  double first_, step_;  // rad
  std::vector<float> ranges_;
};

/// The walls on both sides of a lane of this half width (m), around a car `y` (m) to the left of its middle.
inline std::vector<Wall> beside_lane(double half_width, double y = 0) {
  return {{{-50, half_width - y}, {50, half_width - y}}, {{-50, -half_width - y}, {50, -half_width - y}}};
}

/// SVG-MPPI that plans steering with 512 samples.
inline SvgMppiOptions few_steering_samples() {
  SvgMppiOptions method = closed_form(1);
  method.horizon = 20;
  method.samples = 512;
  method.variance = 0.03;
  method.guides.variance = method.guides.gradient_variance = 0.01;
  method.guides.step = 0.005;
  method.variance_min = 0.001;
  method.variance_max = 0.1;
  method.input_min = -0.4;
  method.input_max = 0.4;
  return method;
}

}  // namespace slalom::testing
