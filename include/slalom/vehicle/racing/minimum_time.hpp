#pragma once

#include "slalom/vehicle/course/track_generator.hpp"
#include "slalom/vehicle/racing/corridor.hpp"
#include "slalom/vehicle/racing/racing_car.hpp"

namespace slalom::vehicle {

/// A line with its speeds.
struct Raceline {
  std::vector<RacelinePoint> points{};  ///< one for each point of the corridor
  double length = 0;                    ///< m, along the points, and back to the first if the line is closed
  double time = 0;                      ///< s, along the points, and back to the first if the line is closed
  bool closed = true;                   ///< whether the first point follows the last one
  double curvature_limit = 0;  ///< 1/m, that the line obeys: max_curvature() of the car, or more where the
                               ///< corridor forces it to turn more tightly
};

/// The line through a corridor, and the speeds along it, that take a car the least time:
///
///   minimise  sum_i 2 d_i / (v_i + v_{i+1})   over offsets n_i and speeds v_i, d_i = |p_{i+1} - p_i|,
///   p_i = c_i + n_i e_i  (c_i the centre line, e_i its normals)
///   subject to
///     -(right_i - r_i) <= n_i <= left_i - r_i               r_i = wall_distance(car, left_i + right_i)
///     |k_i| <= tan(max_steering) / wheelbase                k_i the curvature of p_{i-1}, p_i, p_{i+1}
///     v_i <= top_speed,    a_i v_i <= power                 a_i = (v_{i+1}^2 - v_i^2) / (2 d_i)
///     (v_j^2 k_j / lateral)^2 + (a_i / along)^2 <= 1        j = i, i+1; along: acceleration or braking
///     v_i |k_{i+1} - k_i| wheelbase / d_i <= max_steering_rate
///
/// A point mass with a friction ellipse (Heilmeier et al. 2020; see raceline.hpp) whose line and speeds are
/// optimised together. Solved by a logarithmic barrier method (Boyd & Vandenberghe, "Convex Optimization",
/// 2004, Sec. 11.3) with exact second derivatives; the result is a local minimum, within about 0.1 % of its
/// time. The speeds returned are those of racing_speeds() along the line. Throws std::invalid_argument for an
/// invalid car, fewer than 8 points, a corridor whose normals cross, or one that is somewhere narrower than
/// the car with `least_margin_share` of its margin on both sides; the message names the narrowest place.
Raceline minimum_time_raceline(const Corridor& corridor, const RacingCar& car);

}  // namespace slalom::vehicle
