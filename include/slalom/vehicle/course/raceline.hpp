#pragma once

#include <vector>

#include "slalom/maps/pose.hpp"

namespace slalom::vehicle {

/// Lateral offsets (m, to the left) from a closed centre line, one per point, for the least curvature:
///
///   minimise  sum_i | (p_{i-1} + a_{i-1} n_{i-1}) - 2 (p_i + a_i n_i) + (p_{i+1} + a_{i+1} n_{i+1}) |^2
///   subject to  |a_i| <= bound,
///
/// p the points of the centre line at equal steps, n their normals: the second difference stands for the
/// curvature. Source: Heilmeier et al., "Minimum curvature trajectory planning and control for an autonomous
/// race car", Vehicle System Dynamics 58(10), 2020, Sec. 3, which takes derivatives of splines; here plain
/// differences, since the points are close. The quadratic program is solved by projected successive
/// over-relaxation from coarse to fine. Throws std::invalid_argument on fewer than 8 points or a bound < 0 m.
std::vector<double> minimum_curvature_offsets(const std::vector<maps::Point>& centre_line, double bound);

}  // namespace slalom::vehicle
