#include "sim/gym/gym_scan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace slalom::sim::detail {
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

const Table& table() {
  static const Table made;
  return made;
}

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
    const auto column = static_cast<std::size_t>(gx / resolution),
               row = static_cast<std::size_t>(gy / resolution);
    return distance[row * static_cast<std::size_t>(width) + column];
  }

  const double* distance;
  int width, height;
  double resolution;
  maps::Pose origin;
  double cosine, sine;
};

}  // namespace

GymDirections::GymDirections(double yaw, const LidarOptions& options)
    : index_(std::fmod(table_size * (yaw + options.angle_min()) / (2 * pi), table_size)),
      increment_(table_size * options.angle_increment() / (2 * pi)) {
  while (index_ < 0) index_ += table_size;
}

maps::Point GymDirections::next() {
  // A tiny negative angle plus a turn may round to the table's size.
  const auto entry = std::min(static_cast<std::size_t>(index_), std::size_t{table_size - 1});
  index_ += increment_;
  while (index_ >= table_size) index_ -= table_size;
  return {table().cosine[entry], table().sine[entry]};
}

double gym_distance(const Track& track, const maps::Point& point) {
  return Field(track).at(point.x, point.y);
}

void gym_scan(const Track& track, const maps::Pose& sensor, const LidarOptions& options,
              std::span<const double> angles, std::span<double> ranges) {
  constexpr double close_enough = 1e-4;  // m, to a wall
  const Field field(track);
  const double from_start = field.at(sensor.x, sensor.y);
  GymDirections directions(sensor.yaw, options);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double angle = sensor.yaw + angles[i];
    const maps::Point to =
        options.gym.directions ? directions.next() : maps::Point{std::cos(angle), std::sin(angle)};
    double x = sensor.x, y = sensor.y, step = from_start, total = from_start;
    while (step > close_enough && total <= options.range_max) {
      x += step * to.x;
      y += step * to.y;
      step = field.at(x, y);
      total += step;
    }
    ranges[i] = std::min(total, options.range_max);
  }
}

}  // namespace slalom::sim::detail
