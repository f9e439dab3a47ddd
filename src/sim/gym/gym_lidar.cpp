// The scan of f1tenth_gym. A beam walks from cell to cell by the cells' distances to the nearest wall, centre
// to centre, until it is in a wall cell, so that ranges are up to a cell off.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/gym/gym_distance.hpp"
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
      const double angle = static_cast<double>(i) * (2 * pi / (table_size - 1));
      cosine[i] = std::cos(angle);
      sine[i] = std::sin(angle);
    }
  }
};

/// The distance field as it is looked up.
struct Field {
  explicit Field(const Track& track)
      : distance(track.distance().distance.data()),
        width(track.grid().width),
        height(track.grid().height),
        resolution(track.grid().resolution),
        origin(track.grid().origin),
        cosine(std::cos(origin.yaw)),
        sine(std::sin(origin.yaw)) {}

  double at(double x, double y) const {
    const double dx = x - origin.x, dy = y - origin.y;
    const double gx = dx * cosine + dy * sine, gy = -dx * sine + dy * cosine;
    if (gx < 0 || gy < 0 || !(gx < width * resolution) || !(gy < height * resolution))
      return distance[static_cast<std::size_t>(width) * static_cast<std::size_t>(height) - 1];
    const int column = saturate_cast<int>(gx / resolution), row = saturate_cast<int>(gy / resolution);
    return distance[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(column)];
  }

  const double* distance;
  int width, height;
  double resolution;
  maps::Pose origin;
  double cosine, sine;
};

}  // namespace

double detail::gym_distance(const Track& track, const maps::Point& point) {
  return Field(track).at(point.x, point.y);
}

void Lidar::gym_scan(const Track& track, const maps::Pose& sensor, std::span<double> ranges) const noexcept {
  static const Table table;
  constexpr double close_enough = 1e-4;  // m, to a wall
  const Field field(track);
  const double from_start = field.at(sensor.x, sensor.y);
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
      step = field.at(x, y);
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
    const double increment = options_.angle_increment(), last = static_cast<double>(options_.beams - 1);
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
    const auto beam = static_cast<std::size_t>(i);
    const double angle = sensor.yaw + angles_[beam];
    ranges[beam] =
        std::min(ranges[beam], ray_distance({sensor.x, sensor.y}, std::cos(angle), std::sin(angle), body));
  }
}

void Lidar::gym_cast(const maps::Pose& sensor, const Box& box, std::span<double> ranges) const noexcept {
  gym_shorten(sensor, box, gym_window(sensor, box), ranges);
}

void Lidar::gym_cast(const maps::Pose& sensor, const Disc& disc, std::span<double> ranges) const noexcept {
  gym_shorten(sensor, disc, window(sensor, disc.middle, disc.radius), ranges);
}

}  // namespace slalom::sim
