// The scan of f1tenth_gym. A beam walks from cell to cell by the cells' distances to the nearest wall, centre
// to centre, until it is in a wall cell, so that ranges are up to a cell off.
#include <algorithm>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/sim/lidar.hpp"

namespace slalom::sim {
namespace {

using std::numbers::pi;
constexpr int table_size = 2000;

/// Cosines and sines of 2000 angles from 0 to 2 pi, both ends included.
struct Table {
  std::array<double, table_size> cosine, sine;
  Table() {
    for (std::size_t i = 0; i < table_size; ++i) {
      const double angle = i * (2 * pi / (table_size - 1));
      cosine[i] = std::cos(angle);
      sine[i] = std::sin(angle);
    }
  }
};

/// As Track::gym_distance, which the compiler does not inline.
double distance_at(const Track& track, const maps::Point& point) {
  const maps::Point cell = track.to_cells(point);
  if (!track.contains(cell)) return track.distance().distance.back();
  return track.distance().at(saturate_cast<int>(cell.x), saturate_cast<int>(cell.y));
}

}  // namespace

double Track::gym_distance(const maps::Point& point) const noexcept {
  return distance_at(*this, point);
}

void Lidar::gym_scan(const Track& track, const maps::Pose& sensor, std::span<double> ranges) const noexcept {
  static const Table table;
  constexpr double close_enough = 1e-4;  // m, to a wall
  const double from_start = distance_at(track, {sensor.x, sensor.y});
  const double increment = table_size * options_.angle_increment() / (2 * pi);
  double index = std::fmod(table_size * (sensor.yaw + options_.angle_min()) / (2 * pi), table_size);
  while (index < 0) index += table_size;
  for (double& range : ranges) {
    // A tiny negative angle plus a turn may round to the table's size.
    const auto entry = std::min(saturate_cast<std::size_t>(index), std::size_t{table_size - 1});
    double x = sensor.x, y = sensor.y, step = from_start, total = from_start;
    while (step > close_enough && total <= options_.range_max) {
      x += step * table.cosine[entry];
      y += step * table.sine[entry];
      step = distance_at(track, {x, y});
      total += step;
    }
    range = std::min(total, options_.range_max);
    index += increment;
    while (index >= table_size) index -= table_size;
  }
}

/// The beams between those nearest to a car's corners.
Lidar::Window Lidar::gym_window(const maps::Pose& sensor, const Box& box) const noexcept {
  Window all{options_.beams - 1, 0};
  const double heading = std::atan2(std::sin(sensor.yaw), std::cos(sensor.yaw));
  for (const maps::Point& corner : corners(box)) {
    const double dx = corner.x - sensor.x, dy = corner.y - sensor.y, distance = std::sqrt(dx * dx + dy * dy);
    double angle = heading - std::atan2(dy / distance, dx / distance);
    if (angle > pi) angle -= 2 * pi;
    if (angle < -pi) angle += 2 * pi;
    const auto nearer = [&](double a, double b) { return std::abs(a + angle) < std::abs(b + angle); };
    // The beams stand evenly, so the nearest is one of the few about where it should be.
    const double increment = options_.angle_increment(), last = options_.beams - 1;
    const double about = increment > 0 ? (-angle - angles_.front()) / increment : 0;
    const auto begin = angles_.begin() + saturate_cast<std::ptrdiff_t>(std::clamp(about - 2, 0.0, last)),
               end = angles_.begin() + saturate_cast<std::ptrdiff_t>(std::clamp(about + 3, 0.0, last)) + 1;
    const auto nearest = std::min_element(begin, end, nearer);
    const int beam = static_cast<int>(nearest - angles_.begin());
    all.first = std::min(all.first, beam);
    all.last = std::max(all.last, beam);
  }
  return all;
}

template <class Body>
void Lidar::gym_shorten(const maps::Pose& sensor, const Body& body, Window beams,
                        std::span<double> ranges) const noexcept {
  for (int i = beams.first; i <= beams.last; ++i) {
    const double angle = sensor.yaw + angles_[i];
    ranges[i] =
        std::min(ranges[i], ray_distance({sensor.x, sensor.y}, std::cos(angle), std::sin(angle), body));
  }
}

void Lidar::gym_cast(const maps::Pose& sensor, const Box& box, std::span<double> ranges) const noexcept {
  gym_shorten(sensor, box, gym_window(sensor, box), ranges);
}

void Lidar::gym_cast(const maps::Pose& sensor, const Disc& disc, std::span<double> ranges) const noexcept {
  gym_shorten(sensor, disc, window(sensor, disc.middle, disc.radius), ranges);
}

}  // namespace slalom::sim
