#pragma once

#include "slalom/core/grid_view.hpp"
#include "slalom/navigation/costmap.hpp"

namespace slalom::navigation {

/// Checks a body against the distances of a costmap, for rollouts. The parts of the footprint decide first:
/// no obstacle is near a part, or one is inside. Where neither is certain, the points of the outline do, at
/// most a cell apart. So every overlap deeper than half a cell is found but a single cell that does not touch
/// the outline, which a body in steps shorter than a cell meets with its outline first.
class BodyCheck {
 public:
  /// For costmaps of this resolution (m).
  BodyCheck(const Footprint& footprint, double resolution)
      : unsure_(1.42 * resolution), half_cell_(0.5 * resolution) {
    for (std::size_t i = 0; i < free_.size(); ++i)
      free_[i] = (static_cast<double>(1 << i) + 1.42) * resolution;
    const std::vector<maps::Point> points = footprint.outline_points(resolution);
    count_ = points.size();
    for (std::size_t i = 0; i < count_ + 32; ++i) {
      x_.push_back(static_cast<float>(points[i % count_].x));
      y_.push_back(static_cast<float>(points[i % count_].y));
    }
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Footprint::Part& part = footprint.parts()[i];
      // A position lies within half of a diagonal (0.71 edges) of the middle of its cell.
      parts_[i] = {part.middle.x, part.middle.y, part.contained - 0.71 * resolution, part.covering};
    }
  }

  /// The values that the maps hold at a pose.
  template <class T>
  struct Contact {
    T clearance;         ///< m, from the body to the nearest obstacle, within about a cell
    mask_t<T> collided;  ///< whether they overlap
  };

  /// Checks the body at (x, y), m, turned by the angle of this sine and cosine; its outline, too, where
  /// `exact`.
  template <class T>
  SLALOM_INLINE_CALLS Contact<T> check(const GridView<1>& distances, const T& x, const T& y, const T& sine,
                                       const T& cosine, const mask_t<T>& exact) const {
    T clearance = T(Costmap::reach);
    mask_t<T> collided(false), unsure(false);
    for (const Part& part : parts_) {
      const T distance = look_up_at(distances, T(part.x), T(part.y), x, y, sine, cosine);
      const T around = distance - T(part.covering);
      clearance = min(clearance, around);
      collided = collided | (distance < T(part.contained));
      unsure = unsure | (around < T(unsure_));
    }
    unsure = unsure & exact & !collided;
    if (any(unsure)) collided = collided | meets_outline(distances, x, y, sine, cosine, unsure);
    return {max(clearance - T(half_cell_), T(0)), collided};
  }

 private:
  struct Part {
    Coefficient x, y;       ///< m, its middle in the robot's frame
    Coefficient contained;  ///< m; an obstacle whose distance is less is inside
    Coefficient covering;   ///< m
  };

  template <class T>
  SLALOM_INLINE_CALLS static T look_up_at(const GridView<1>& distances, const T& along, const T& left,
                                          const T& x, const T& y, const T& sine, const T& cosine) {
    return look_up(distances, x + cosine * along - sine * left, y + sine * along + cosine * left);
  }

  /// Whether an obstacle is on the outline of those bodies that are asked for.
  template <class T>
  SLALOM_INLINE_CALLS mask_t<T> meets_outline(const GridView<1>& distances, const T& x, const T& y,
                                              const T& sine, const T& cosine, mask_t<T> asked) const {
    if constexpr (requires { T::lanes; }) {
      int bodies = 0;
      for (int lane = 0; lane < T::lanes; ++lane) bodies += asked[lane];
      if (2 * bodies <= T::lanes) return meets_outlines(distances, x, y, sine, cosine, asked);
    }
    mask_t<T> met(false);
    // Points nearer than the nearest obstacle are free. One ahead may decide for all up to it.
    for (std::size_t first = 0, ahead = 0; first < count_ && any(asked);) {
      const std::size_t at = std::min(first + ahead, count_ - 1);
      const T near = look_up_at(distances, T(x_[at]), T(y_[at]), x, y, sine, cosine);
      met = met | (near < T(half_cell_));
      asked = asked & !met;
      const mask_t<T> known = near < T(Costmap::reach);  // off the map no distance is
      std::size_t level = 0;
      while (level < free_.size() && !any(asked & !(known & (near > T(free_[level]))))) ++level;
      const std::size_t sides = (std::size_t{1} << level) >> 1;
      if (sides >= at - first) first = at + sides + 1;
      ahead = sides;
    }
    return met;
  }
  /// The same for few bodies of a pack, one by one: points of the outline fill the lanes.
  template <class T>
  SLALOM_INLINE_CALLS mask_t<T> meets_outlines(const GridView<1>& distances, const T& x, const T& y,
                                               const T& sine, const T& cosine, const mask_t<T>& asked) const {
    float met[T::lanes] = {};
    for (int lane = 0; lane < T::lanes; ++lane) {
      if (!asked[lane]) continue;
      const T at_x(x[lane]), at_y(y[lane]), s(sine[lane]), c(cosine[lane]);
      for (std::size_t i = 0; i < count_ && met[lane] == 0; i += T::lanes)
        met[lane] =
            any(look_up_at(distances, T::load(&x_[i]), T::load(&y_[i]), at_x, at_y, s, c) < T(half_cell_));
    }
    return T::load(met) > T(0);
  }

  std::array<Part, Footprint::part_count> parts_;
  std::vector<float> x_, y_;  ///< m, points of the outline, and the first ones again
  std::size_t count_ = 0;     ///< number of points
  Coefficient unsure_;        ///< m of clearance below which the outline decides
  Coefficient half_cell_;     ///< m
  /// m to an obstacle, beyond which 1, 2, 4, ... points to each side are free
  std::array<Coefficient, 6> free_;
};

}  // namespace slalom::navigation
