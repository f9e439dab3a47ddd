#pragma once

#include "slalom/core/options.hpp"
#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/cell_grid.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/maps/reference_path.hpp"

namespace slalom::maps {

/// The result of a look-up off a reference map.
struct ReferenceOutside {
  double distance = 20;
  double yaw = 2.0;  ///< The value of the paper's program (proj-svg_mppi).
  double speed = 0;
};

/// Options of ReferenceField. `visit_options` below describes the fields.
struct ReferenceFieldOptions {
  double length_x = 20;
  double length_y = 20;
  double resolution = 0.1;
  int points = 80;
  double spacing = 0.1;
  ReferenceOutside outside{};  ///< result of a look-up off the map

  /// With 0 the distance of those behind the nearest point is to the window's first point, not the path.
  int points_behind = 10;
};

template <class Options, class Visit>
requires is_options_of<Options, ReferenceFieldOptions>
void visit_options(Options& options, Visit&& visit) {
  visit(options.length_x, {"length_x", "m", "length of the map", 1e-3, 1e4});
  visit(options.length_y, {"length_y", "m", "width of the map", 1e-3, 1e4});
  visit(options.resolution, {"resolution", "m", "size of a cell", 1e-4, 100});
  visit(options.points,
        {"points", "", "points of the window, from the nearest on; points + points_behind <= 250", 1, 250});
  visit(options.points_behind,
        {"points_behind", "", "points of the window behind the nearest, in addition", 0, 249});
  visit(options.spacing, {"spacing", "m", "least distance between successive points of the window", 0, 1e4});
  visit(options.outside.distance, {"outside_distance", "m", "distance to the path off the map", -1e30, 1e30});
  visit(options.outside.yaw, {"outside_yaw", "rad", "yaw error off the map", -7, 7});
  visit(options.outside.speed, {"outside_speed", "m/s", "speed of the path off the map", -1e3, 1e3});
}

/// A map centred on the robot, parallel to the map frame, that holds for every cell the distance to the
/// nearest of a window of the path's points, with that point's yaw and speed; with set_curvatures, to the
/// nearest place of the line. The window begins at the robot's place (see place_on_path) and wraps at the
/// path's end. Each update computes the map again, because its cells move with the robot.
///
/// The nearest points are exact in double arithmetic: along a row of cells squared distances are parabolas,
/// whose lower envelope is built (as for the distance transform). After construction nothing allocates.
class ReferenceField {
 public:
  /// Throws std::invalid_argument where the path or the options break a rule.
  explicit ReferenceField(std::span<const ReferencePoint> path, const ReferenceFieldOptions& options = {});

  /// Computes the map around a robot. With a finite `reach` only the cells within it (m, along each axis) are
  /// computed; the others keep their values and must not be looked up. A rollout reaches at most its duration
  /// times its largest speed. With `seconds` the reach is at least 1 m more than the distance driven in that
  /// time at the largest speed in the map. Returns false and changes nothing if the pose is not finite.
  bool update(const Pose& robot, double reach = std::numeric_limits<double>::infinity(),
              double seconds = 0) noexcept;

  /// Forgets where the robot was.
  void reset() noexcept { is_placed_ = false; }

  /// Changes the speeds (m/s, one for each point of the path) from the next update on; no other number of
  /// them has an effect.
  void set_speeds(std::span<const double> speeds) noexcept;

  /// The path's curvatures, 1/m, positive to the left, one for each point; no other number of them has an
  /// effect. `closed`: the last point is joined to the first one. From the next update on, distance, yaw and
  /// speed of a cell are those of the nearest place of the line, between points too: the speed is linear in
  /// the arc length, the yaw follows the curvature. And `outside` is minus the progress along the path of a
  /// position that moves a metre parallel to it: -1 / (1 - k d) with the curvature k at the nearest point and
  /// the distance d to the left of it; within [-4, -0.25]. Allocates.
  void set_curvatures(std::span<const double> curvatures, bool closed);

  /// Replaces the path, which has no curvatures then, from the next update on. Returns false and changes
  /// nothing unless the new one has 3 points to as many as that of the construction. They must meet
  /// check_reference_path.
  bool set_path(std::span<const ReferencePoint> path) noexcept;

  /// The cell at a position, m.
  ReferenceCell at(double x, double y) const noexcept;

  /// The options given at construction.
  const ReferenceFieldOptions& options() const noexcept { return options_; }
  /// Position and size of the cells.
  const GridGeometry& geometry() const noexcept { return geometry_; }
  /// The cells.
  const CellGrid<4>& cells() const noexcept { return cells_; }

  /// The cells {distance, yaw, speed, outside} (see ReferenceCell and set_curvatures), in the map frame, for
  /// the look-ups of rollouts; until the next update.
  GridView<4> view() const noexcept { return cells_.view(geometry_); }

  /// Index of the path's point at which the robot was at the last update.
  int nearest() const noexcept { return nearest_; }

  /// How far the last update made the map, m along each axis.
  double reach() const noexcept { return reach_; }

  /// The window's points of the last update as indices into the path, in the path's order.
  std::span<const int> window() const noexcept { return {window_.data(), window_size_}; }

 private:
  /// The line around a point, for the cells beside it.
  struct Piece {
    double ahead_x = 1, ahead_y = 0;           ///< unit vector along the line
    double curvature = 0;                      ///< 1/m
    double begin = 0, end = 0;                 ///< m along the line, half-way to the window's next points
    double slope_before = 0, slope_after = 0;  ///< 1/s, of the speed over the arc length
  };
  /// A point of the window, with its values for the rows.
  struct Site {
    double x = 0, y = 0;
    double u = 0;  ///< y as a column coordinate, 0 at the centre of column 0
    float yaw = 0, speed = 0;
    Piece piece{};  ///< curvatures, where they are known
  };
  struct Parabola {
    double u = 0;       ///< column coordinate of its site
    double height = 0;  ///< squared distance of the site from the row, in cells^2
    double start = 0;   ///< column coordinate from which on it is the lowest
    const Site* site = nullptr;
  };

  int place_of(const Pose& robot) const noexcept;
  void choose_window() noexcept;
  void make_sites() noexcept;
  int build_envelope(double x) noexcept;
  void write_row(int row, int begin, int end, int parabolas) noexcept;
  void interpolate(int row, int begin, int end, const Site& site) noexcept;
  Piece piece_at(std::size_t before_point, std::size_t point, std::size_t after_point) const noexcept;

  ReferenceFieldOptions options_;
  GridGeometry geometry_;
  CellGrid<4> cells_;
  ReservedVector<ReferencePoint> path_;
  ReservedVector<double> path_x_, path_y_;
  std::vector<double> curvature_;  ///< 1/m; empty if unknown
  bool closed_ = true;             ///< whether the path is closed, where curvatures are known
  std::vector<double> column_y_;   ///< m, of the columns' cells
  double reach_ = 0;
  int nearest_ = 0;
  bool is_placed_ = false;  ///< whether `nearest_` is where the robot was
  std::vector<int> window_;
  std::size_t window_size_ = 0;
  std::vector<Site> sites_;
  std::vector<Parabola> envelope_;
};

}  // namespace slalom::maps
