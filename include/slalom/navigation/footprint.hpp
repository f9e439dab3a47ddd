#pragma once

#include <array>
#include <span>
#include <vector>

#include "slalom/maps/pose.hpp"

namespace slalom::navigation {

/// The outline of a robot, with bounds that decide most collision checks without it. All in the robot's frame
/// (m): x forward, y to the left, origin where the robot's pose is.
class Footprint {
 public:
  /// A part of the body between two discs about one point.
  struct Part {
    maps::Point middle;    ///< m, robot's frame
    double contained = 0;  ///< m, radius of a disc that lies in the body
    double covering = 0;   ///< m, radius of a disc that covers the part
  };
  static constexpr int part_count = 3;       ///< along the longer side of the bounding box
  static constexpr int max_vertices = 32;    ///< most vertices of an outline
  static constexpr double max_extent = 100;  ///< m, from the origin to a vertex

  /// A simple polygon, its vertices in order. Throws std::invalid_argument, naming the vertex, unless there
  /// are 3 to 32 of them within 100 m of the origin, with the origin inside, and no sides cross.
  explicit Footprint(std::span<const maps::Point> vertices);

  /// A rectangle: `front` and `rear` (m) are the distances from the origin to its front and rear side.
  static Footprint rectangle(double front, double rear, double width);

  /// The outline moved inward by `rim` (m), or outward if it is below 0. Where that leaves nothing around the
  /// origin: the same shape, smaller around the origin, its half width less by `rim`, but at least a fifth.
  Footprint without_rim(double rim) const;
  /// The body, those without a rim of 1, 2, ... 7 steps (m), and a small core.
  std::vector<Footprint> without_rims(double step) const;
  std::span<const maps::Point> vertices() const noexcept { return vertices_; }  ///< the outline
  /// The parts, which together cover the body.
  const std::array<Part, part_count>& parts() const noexcept { return parts_; }
  /// The largest distance of a vertex from the origin, m.
  double circumscribed_radius() const noexcept { return circumscribed_; }
  /// The largest distance of a vertex from the robot's x axis, m: half of its corridor on a straight path.
  double half_width() const noexcept { return half_width_; }

  bool contains(const maps::Point& point) const noexcept;  ///< whether a point of the robot's frame is inside
  /// The distance of a point from the outline, m, whether it is inside or not.
  double distance_to_outline(const maps::Point& point) const noexcept;
  /// Points on the outline, with at most `spacing` (m, > 0) between neighbours.
  std::vector<maps::Point> outline_points(double spacing) const;

 private:
  Part part_of(double from, double to, bool along_x) const;

  std::vector<maps::Point> vertices_;
  std::array<Part, part_count> parts_{};
  double circumscribed_ = 0;
  double half_width_ = 0;
};

}  // namespace slalom::navigation
