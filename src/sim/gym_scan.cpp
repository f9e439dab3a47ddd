#include "sim/gym_scan.hpp"

#include <array>
#include <cmath>

namespace slalom::sim::detail {
namespace {

constexpr double pi = 3.141592653589793;
constexpr int table_size = 2000;
constexpr double close_enough = 1e-4;  // m, to a wall

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

double walk(const Field& field, double x, double y, double cosine, double sine, double most) {
  double step = field.at(x, y), total = step;
  while (step > close_enough && total <= most) {
    x += step * cosine;
    y += step * sine;
    step = field.at(x, y);
    total += step;
  }
  return total > most ? most : total;
}

}  // namespace

double gym_distance(const Track& track, const maps::Point& point) {
  return Field(track).at(point.x, point.y);
}

void gym_scan(const Track& track, const maps::Pose& sensor, const LidarOptions& options,
              std::span<const double> angles, std::span<double> ranges) {
  const Field field(track);
  double index = std::fmod(table_size * (sensor.yaw + options.angle_min()) / (2 * pi), table_size);
  while (index < 0) index += table_size;
  const double increment = table_size * options.angle_increment() / (2 * pi);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    double cosine, sine;
    if (options.gym_directions) {
      cosine = table().cosine[static_cast<std::size_t>(index)];
      sine = table().sine[static_cast<std::size_t>(index)];
      index += increment;
      while (index >= table_size) index -= table_size;
    } else {
      cosine = std::cos(sensor.yaw + angles[i]);
      sine = std::sin(sensor.yaw + angles[i]);
    }
    ranges[i] = walk(field, sensor.x, sensor.y, cosine, sine, options.range_max);
  }
}

}  // namespace slalom::sim::detail
