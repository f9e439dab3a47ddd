#pragma once

#include <array>

#include "slalom/maps/pose.hpp"

namespace slalom::sim {

/// A rectangle; its pose is that of its middle.
struct Box {
  maps::Pose pose;    ///< m, m, rad, in the map frame
  double length = 0;  ///< m, along the pose's x
  double width = 0;   ///< m
};

/// A disc.
struct Disc {
  maps::Point middle;  ///< m, map frame
  double radius = 0;   ///< m
};

/// The corners of a box: rear left, rear right, front right, front left.
std::array<maps::Point, 4> corners(const Box& box) noexcept;

/// How far two bodies are apart along the best separating axis (m): above 0 where they are apart, not above 0
/// where they collide; there it is minus the shortest push that separates two boxes. Exact in sign
/// (separating axis theorem for convex bodies); apart, it is at most their distance.
double signed_gap(const Box& a, const Box& b) noexcept;
/// Gap in m, negative if they overlap.
double signed_gap(const Box& a, const Disc& b) noexcept;

/// The way (m) from a point along a direction (`cosine`, `sine`, of length 1) to the outline of a body, from
/// inside or outside; infinity if the ray misses it.
double ray_distance(const maps::Point& from, double cosine, double sine, const Box& box) noexcept;
/// Distance along a ray to a disc, m; infinite if it misses.
double ray_distance(const maps::Point& from, double cosine, double sine, const Disc& disc) noexcept;

}  // namespace slalom::sim
