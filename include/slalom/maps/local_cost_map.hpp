#pragma once

#include "slalom/core/options.hpp"
#include "slalom/maps/cell_grid.hpp"
#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/maps/published.hpp"

namespace slalom::maps {

/// How far the car's body reaches from its reference point (the rear axle): metres, all >= 0.
struct Footprint {
  double front = 0.47;  ///< m, ahead of the origin
  double rear = 0.14;   ///< m, behind it
  double left = 0.15;   ///< m, to its left
  double right = 0.15;  ///< m, to its right
};

/// Options of LocalCostMap. `visit_options` below describes the fields.
struct LocalCostMapOptions {
  double length_x = 10;
  double length_y = 10;
  double resolution = 0.05;
  double center_x = 3;
  double center_y = 0;
  double occupied = 100;
  double outside = 100;
  Footprint footprint{};  ///< the body by which obstacles are inflated
  double margin = 0;
  double soft_margin = 0;
  double soft = 10;
  Pose laser{0.275, 0, 0};  ///< the laser's pose in the robot's frame
  int max_beams = 4096;

  bool drop_points_on_body = true;
  double body_inset = 0.05;

  PublishedCostMap published{};  ///< only to reproduce the program of K. Honda (proj-svg_mppi)
};

template <class Options, class Visit>
requires is_options_of<Options, LocalCostMapOptions>
void visit_options(Options& options, Visit&& visit) {
  visit(options.length_x, {"length_x", "m", "length of the map", 1e-3, 1e4});
  visit(options.length_y, {"length_y", "m", "width of the map", 1e-3, 1e4});
  visit(options.resolution, {"resolution", "m", "size of a cell", 1e-4, 100});
  visit(options.center_x, {"center_x", "m", "centre of the map, ahead of the robot", -1e4, 1e4});
  visit(options.center_y, {"center_y", "m", "centre of the map, to the left of the robot", -1e4, 1e4});
  visit(options.occupied,
        {"occupied", "", "value of a cell where the body would collide with an obstacle", -1e30, 1e30});
  visit(options.outside, {"outside", "", "value of the ring of cells around the map", -1e30, 1e30});
  visit(options.footprint.front, {"footprint_front", "m", "reach of the body ahead", 0, 100});
  visit(options.footprint.rear, {"footprint_rear", "m", "reach of the body behind", 0, 100});
  visit(options.footprint.left, {"footprint_left", "m", "reach of the body to the left", 0, 100});
  visit(options.footprint.right, {"footprint_right", "m", "reach of the body to the right", 0, 100});
  visit(options.margin, {"margin", "m", "added to every side of the body", 0, 100});
  visit(options.laser.x, {"laser_x", "m", "position of the laser, ahead of the reference point", -100, 100});
  visit(options.laser.y,
        {"laser_y", "m", "position of the laser, to the left of the reference point", -100, 100});
  visit(options.laser.yaw, {"laser_yaw", "rad", "direction of the laser", -7, 7});
  visit(options.max_beams, {"max_beams", "", "largest number of beams of a scan", 1, 1000000});
  visit(options.soft_margin,
        {"soft_margin", "m", "width beyond the margin in which cells have the value `soft`", 0, 10});
  visit(options.soft, {"soft", "", "value of a cell where the body would come near an obstacle", 0});
  visit(options.drop_points_on_body,
        {"drop_points_on_body", "",
         "ignore points of a scan within the body (without margin): the car sees itself"});
  visit(options.body_inset,
        {"body_inset", "m", "points less deep within the body stay: an obstacle at its side remains visible",
         0, 10});
  visit(options.published.half_open_inflation,
        {"half_open_inflation", "", "paper's program: inflate by whole cells, by one cell less to one side"});
  visit(options.published.forget_points_outside,
        {"forget_points_outside", "", "paper's program: ignore points off the map"});
}

/// A point in the robot's frame: m.
struct ScanPoint {
  float x;  ///< m
  float y;  ///< m
};

/// Counts of the beams of a scan by their use.
struct ScanReport {
  bool accepted =
      false;        ///< false: empty, too many beams, angles not finite, or not 0 <= range_min < range_max
  int beams = 0;    ///< number of beams of the scan
  int invalid = 0;  ///< NaN, 0, below range_min (so negative), or range_max and more (so infinite)
  int on_body = 0;  ///< dropped because they lie within the footprint
  int used = 0;     ///< number of beams that gave a point
};

/// A map of the free ground around the car, in the car's own frame (x ahead, y to the left), from one LiDAR
/// scan: a cell holds `occupied` where the body would collide if the car's reference point were there, `soft`
/// within the soft margin of these cells, else 0. The body is assumed to keep its present heading, and the
/// ground behind an obstacle to be free. After construction nothing allocates.
class LocalCostMap {
 public:
  /// Throws std::invalid_argument where the options break a rule.
  explicit LocalCostMap(const LocalCostMapOptions& options = {});

  /// Computes the map from a scan. After a scan that is not accepted the map is empty; see the report.
  ScanReport update(const LaserScanView& scan) noexcept;

  /// Takes the points of a scan and marks all cells free, for a user of `points()` alone. That takes a small
  /// part of the time of `update`.
  ScanReport read(const LaserScanView& scan) noexcept;

  /// Marks all cells free.
  void clear() noexcept;

  /// Adds obstacle points in the robot's frame, m. Points that are not finite are ignored.
  void add_points(std::span<const Point> points) noexcept;

  /// The value at a position in the robot's frame, m.
  float at(double x, double y) const noexcept {
    const int row = geometry_.row(x), column = geometry_.column(y);
    return row < 0 || column < 0 ? *cells_.data() : *cells_.at(row, column);
  }

  /// The options given at construction.
  const LocalCostMapOptions& options() const noexcept { return options_; }
  /// Position and size of the cells.
  const GridGeometry& geometry() const noexcept { return geometry_; }
  /// The cells.
  const CellGrid<1>& cells() const noexcept { return cells_; }

  /// The cells, in the robot's frame, for the look-ups of rollouts.
  GridView<1> view() const noexcept { return cells_.view(geometry_); }

  /// The points of the last scan that were used; none after clear().
  std::span<const ScanPoint> points() const noexcept { return {points_.data(), point_count_}; }

 private:
  /// A range of rows and columns; the ends are excluded.
  struct Box {
    int row_begin = 0, row_end = 0, column_begin = 0, column_end = 0;
    bool operator==(const Box&) const = default;
  };

  void forget() noexcept;
  void set_beams(const LaserScanView& scan) noexcept;
  /// Sets the points of a scan, and gives each to `use`.
  template <class Use>
  ScanReport take_points(const LaserScanView& scan, Use&& use) noexcept;
  void mark(double x, double y) noexcept;
  /// Sums over boxes: (rows + 1) x columns of the boxes over a cell less those over the cell ahead of it.
  struct Layer {
    std::vector<std::int32_t> differences;
    std::vector<std::int32_t> counts;  ///< boxes over the cells of one row
    Box last_box;
  };

  Box box_round(double u, double v, double wider) const noexcept;
  void count(Layer& layer, const Box& box) noexcept;
  void write_cells() noexcept;

  LocalCostMapOptions options_;
  GridGeometry geometry_;
  CellGrid<1> cells_;
  /// How far a half-open box reaches beyond the cell of the point.
  int cells_ahead_ = 0, cells_behind_ = 0, cells_left_ = 0, cells_right_ = 0;
  Layer hard_, soft_;  ///< cells where the body collides; where it comes near (empty without a soft margin)

  std::vector<double> beam_cos_, beam_sin_;  ///< directions of the beams in the robot's frame
  int beam_count_ = 0;                       ///< how many of them are valid
  bool marked_ = false;                      ///< whether a cell may be occupied
  double beam_start_ = 0, beam_step_ = 0;
  std::vector<ScanPoint> points_;
  std::size_t point_count_ = 0;
};

}  // namespace slalom::maps
