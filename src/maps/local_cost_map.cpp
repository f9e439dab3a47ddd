#include "slalom/maps/local_cost_map.hpp"

#include "maps/validation.hpp"

namespace slalom::maps {
namespace {

/// floor() of a cell coordinate, clamped to [low, high] first, since far positions would not fit an int;
/// `low` for one that is not a number. Counted from `low` on, no number is negative, so that the conversion
/// truncates downwards.
int clamped_floor(double cell, int low, int high) {
  if (!(cell > low)) return low;
  return saturate_cast<int>(std::min(cell, static_cast<double>(high)) - low) + low;
}

}  // namespace

LocalCostMap::LocalCostMap(const LocalCostMapOptions& options)
    : options_(options),
      geometry_(detail::geometry_of(options, "local_cost_map")),
      cells_(geometry_.rows, geometry_.columns) {
  geometry_.center_x = options.center_x;
  geometry_.center_y = options.center_y;
  const auto whole_cells = [&](double reach) {
    return saturate_cast<int>(std::ceil((reach + options.margin) / options.resolution));
  };
  // Row 0 lies at the largest x: a car ahead of a point collides with it with its rear.
  cells_ahead_ = whole_cells(options.footprint.rear);
  cells_behind_ = whole_cells(options.footprint.front);
  cells_left_ = whole_cells(options.footprint.right);
  cells_right_ = whole_cells(options.footprint.left);
  const auto columns = static_cast<std::size_t>(geometry_.columns);
  for (Layer* layer : {&hard_, &soft_}) {
    if (layer == &soft_ && !(options.soft_margin > 0)) continue;
    layer->counts.resize(columns);
    layer->differences.resize(static_cast<std::size_t>(geometry_.rows + 1) * columns);
  }
  const auto beams = static_cast<std::size_t>(options.max_beams);
  beam_cos_.resize(beams);
  beam_sin_.resize(beams);
  points_.resize(beams);
  cells_.fill({static_cast<float>(options.outside)});
  clear();
}

void LocalCostMap::forget() noexcept {
  for (Layer* layer : {&hard_, &soft_}) {
    std::fill(layer->differences.begin(), layer->differences.end(), 0);
    layer->last_box = {};
  }
  point_count_ = 0;
  marked_ = false;
}

void LocalCostMap::clear() noexcept {
  forget();
  write_cells();
}

ScanReport LocalCostMap::update(const LaserScanView& scan) noexcept {
  forget();
  const ScanReport report = take_points(scan, [this](const ScanPoint& point) { mark(point.x, point.y); });
  write_cells();
  return report;
}

ScanReport LocalCostMap::read(const LaserScanView& scan) noexcept {
  if (marked_) clear();
  return take_points(scan, [](const ScanPoint&) {});
}

void LocalCostMap::set_beams(const LaserScanView& scan) noexcept {
  const int count = static_cast<int>(scan.ranges.size());
  const bool same = scan.angle_min == beam_start_ && scan.angle_increment == beam_step_;
  for (int i = same ? beam_count_ : 0; i < count; ++i) {
    const double angle = scan.angle_min + i * scan.angle_increment + options_.laser.yaw;
    beam_cos_[i] = std::cos(angle);
    beam_sin_[i] = std::sin(angle);
  }
  beam_count_ = same ? std::max(count, beam_count_) : count;
  beam_start_ = scan.angle_min;
  beam_step_ = scan.angle_increment;
}

template <class Use>
ScanReport LocalCostMap::take_points(const LaserScanView& scan, Use&& use) noexcept {
  ScanReport report;
  point_count_ = 0;
  if (scan.ranges.empty() || scan.ranges.size() > points_.size() || !std::isfinite(scan.angle_min) ||
      !std::isfinite(scan.angle_increment) || !(scan.range_min >= 0) || !(scan.range_max > scan.range_min)) {
    return report;
  }
  set_beams(scan);
  report.accepted = true;
  report.beams = static_cast<int>(scan.ranges.size());
  // Points and the box of the body are float32, as the messages are that carry them: a point right on the
  // box's edge is then dropped or kept as by that program (proj-svg_mppi).
  const auto laser_x = static_cast<float>(options_.laser.x), laser_y = static_cast<float>(options_.laser.y);
  const auto front = static_cast<float>(options_.footprint.front - options_.body_inset),
             rear = -static_cast<float>(options_.footprint.rear - options_.body_inset);
  const auto left = static_cast<float>(options_.footprint.left - options_.body_inset),
             right = -static_cast<float>(options_.footprint.right - options_.body_inset);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double range = scan.ranges[i];
    if (!(range > 0 && range >= scan.range_min && range < scan.range_max)) {
      ++report.invalid;
      continue;
    }
    const ScanPoint point{static_cast<float>(range * beam_cos_[i]) + laser_x,
                          static_cast<float>(range * beam_sin_[i]) + laser_y};
    if (std::isnan(point.x) || std::isnan(point.y)) {  // the angle is beyond the range of double
      ++report.invalid;
      continue;
    }
    if (options_.drop_points_on_body && point.x >= rear && point.x <= front && point.y >= right &&
        point.y <= left) {
      ++report.on_body;
      continue;
    }
    points_[point_count_++] = point;
    use(point);
  }
  report.used = static_cast<int>(point_count_);
  return report;
}

void LocalCostMap::add_points(std::span<const Point> points) noexcept {
  if (points.empty()) return;
  for (const Point& point : points) {
    if (std::isfinite(point.x) && std::isfinite(point.y)) mark(point.x, point.y);
  }
  write_cells();
}

/// Counts the point (x, y) in every cell where the body would collide with it.
void LocalCostMap::mark(double x, double y) noexcept {
  marked_ = true;
  const PublishedCostMap& reproduction = options_.published;
  const bool by_cells = reproduction.half_open_inflation || reproduction.forget_points_outside;
  int row = by_cells ? geometry_.row(x) : 0, column = by_cells ? geometry_.column(y) : 0;
  if (reproduction.forget_points_outside && (row < 0 || column < 0)) return;
  // The point in units of cells from the corner where row and column 0 begin.
  const double scale = 1 / geometry_.resolution;
  const double u = (geometry_.center_x - x) * scale + 0.5 * geometry_.rows;
  const double v = (geometry_.center_y - y) * scale + 0.5 * geometry_.columns;
  if (reproduction.half_open_inflation) {
    if (row < 0) row = clamped_floor(u, -100000, 100000);
    if (column < 0) column = clamped_floor(v, -100000, 100000);
    count(hard_, {row - cells_ahead_, row + cells_behind_, column - cells_left_, column + cells_right_});
    return;
  }
  // Touching by less than a millionth of a cell is rounding.
  const double wider = options_.margin * scale - 1e-6;
  count(hard_, box_round(u, v, wider));
  if (options_.soft_margin > 0) count(soft_, box_round(u, v, wider + options_.soft_margin * scale));
}

/// The cells in which the reference point stands where the body, `wider` cells larger on every side, covers a
/// point at (u, v) cells.
LocalCostMap::Box LocalCostMap::box_round(double u, double v, double wider) const noexcept {
  const double scale = 1 / geometry_.resolution;
  const Footprint& body = options_.footprint;
  return {clamped_floor(u - body.rear * scale - wider, 0, geometry_.rows),
          clamped_floor(u + body.front * scale + wider, -1, geometry_.rows) + 1,
          clamped_floor(v - body.right * scale - wider, 0, geometry_.columns),
          clamped_floor(v + body.left * scale + wider, -1, geometry_.columns) + 1};
}

/// Adds 1 to the cells of a box, as differences from row to row: two rows to write instead of all.
void LocalCostMap::count(Layer& layer, const Box& box) noexcept {
  // Neighbouring beams often hit the same cell.
  if (box == layer.last_box) return;
  layer.last_box = box;
  const int row_begin = std::max(box.row_begin, 0), row_end = std::min(box.row_end, geometry_.rows);
  const int begin = std::max(box.column_begin, 0), end = std::min(box.column_end, geometry_.columns);
  if (row_begin >= row_end || begin >= end) return;
  std::int32_t* first = layer.differences.data() + static_cast<std::ptrdiff_t>(row_begin) * geometry_.columns;
  std::int32_t* behind = layer.differences.data() + static_cast<std::ptrdiff_t>(row_end) * geometry_.columns;
  for (int column = begin; column < end; ++column) {
    ++first[column];
    --behind[column];
  }
}

/// Sums the differences up and writes the cells.
void LocalCostMap::write_cells() noexcept {
  const auto columns = static_cast<std::size_t>(geometry_.columns);
  const auto occupied = static_cast<float>(options_.occupied), soft = static_cast<float>(options_.soft);
  const auto sum_row = [&](Layer& layer, int row) {
    if (row == 0) std::fill(layer.counts.begin(), layer.counts.end(), 0);
    const std::int32_t* differences = layer.differences.data() + static_cast<std::size_t>(row) * columns;
    std::int32_t* counts = layer.counts.data();
    for (std::size_t column = 0; column < columns; ++column) counts[column] += differences[column];
    return counts;
  };
  for (int row = 0; row < geometry_.rows; ++row) {
    float* cells = cells_.at(row, 0);
    const std::int32_t* hard = sum_row(hard_, row);
    if (options_.soft_margin > 0) {
      const std::int32_t* near = sum_row(soft_, row);
      for (std::size_t column = 0; column < columns; ++column) {
        cells[column] = hard[column] > 0 ? occupied : near[column] > 0 ? soft : 0.0F;
      }
    } else {
      for (std::size_t column = 0; column < columns; ++column) {
        cells[column] = hard[column] > 0 ? occupied : 0.0F;
      }
    }
  }
}

}  // namespace slalom::maps
