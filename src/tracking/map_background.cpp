#include "tracking/map_background.hpp"

#include <algorithm>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/maps/distance_field.hpp"

namespace slalom::tracking {
namespace {

constexpr int aligned_readings = 120, max_steps = 6;  // readings, and steps of an alignment
constexpr double outlier = 0.15;          // m, distance at which a reading has a quarter of its weight
constexpr double least_deviation = 1e-4;  // m and rad, of the pose

/// Solves A x = b for a symmetric positive definite matrix by its Cholesky decomposition; false if it is not.
bool solve(double (&a)[3][3], double (&b)[3]) noexcept {
  for (int j = 0; j < 3; ++j) {
    for (int k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
    if (!(a[j][j] > 0)) return false;
    a[j][j] = std::sqrt(a[j][j]);
    for (int i = j + 1; i < 3; ++i) {
      for (int k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      a[i][j] /= a[j][j];
    }
  }
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (int i = 2; i >= 0; --i) {
    for (int k = i + 1; k < 3; ++k) b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
  return true;
}

}  // namespace

MapBackground::MapBackground(const maps::OccupancyGrid& map)
    : width_((maps::check_grid(map), map.width)),
      height_(map.height),
      resolution_(map.resolution),
      origin_(map.origin),
      cosine_(std::cos(map.origin.yaw)),
      sine_(std::sin(map.origin.yaw)),
      distance_(map.cells.size()) {
  maps::OccupancyGrid inverse = map;
  for (maps::Occupancy& each : inverse.cells)
    each = each == maps::Occupancy::free ? maps::Occupancy::occupied : maps::Occupancy::free;
  const maps::DistanceField outside = maps::distance_transform(map, true),
                            inside = maps::distance_transform(inverse, false);
  const double half = 0.5 * resolution_;  // from the centre of a cell to its outline
  for (std::size_t i = 0; i < distance_.size(); ++i) {
    const double signed_distance =
        outside.distance[i] > 0 ? outside.distance[i] - half : half - inside.distance[i];
    // Without any obstacle, or without any free cell, distances are infinite.
    distance_[i] = static_cast<float>(std::clamp(signed_distance, -1e6, 1e6));
  }
}

double MapBackground::cell(int column, int row) const noexcept {
  return distance_[static_cast<std::size_t>(row) * width_ + column];
}

MapBackground::Slope MapBackground::slope(const maps::Point& point) const noexcept {
  const double dx = point.x - origin_.x, dy = point.y - origin_.y;
  const double x = (cosine_ * dx + sine_ * dy) / resolution_ - 0.5,
               y = (-sine_ * dx + cosine_ * dy) / resolution_ - 0.5;  // in cells, from the first centre
  if (!(x >= 0 && y >= 0 && x < width_ - 1 && y < height_ - 1)) return {0, 0, 0};
  const int column = saturate_cast<int>(x), row = saturate_cast<int>(y);
  const double u = x - column, v = y - row;
  const double d00 = cell(column, row), d10 = cell(column + 1, row), d01 = cell(column, row + 1),
               d11 = cell(column + 1, row + 1);
  const double along = ((1 - v) * (d10 - d00) + v * (d11 - d01)) / resolution_,
               across = ((1 - u) * (d01 - d00) + u * (d11 - d10)) / resolution_;
  return {(1 - v) * ((1 - u) * d00 + u * d10) + v * ((1 - u) * d01 + u * d11),
          cosine_ * along - sine_ * across, sine_ * along + cosine_ * across};
}

double MapBackground::distance(const maps::Point& point) const noexcept {
  return slope(point).distance;
}

maps::Pose MapBackground::align(const Readings& readings, const maps::Pose& sensor, double position_deviation,
                                double yaw_deviation, double range_deviation) const noexcept {
  const auto all = readings.all();
  const std::size_t every = std::max<std::size_t>(1, all.size() / aligned_readings);
  // Errors of the map count as those of the readings.
  const double noise = range_deviation * range_deviation + resolution_ * resolution_ / 4;
  const double position = std::max(position_deviation, least_deviation),
               yaw = std::max(yaw_deviation, least_deviation);
  const double prior[3] = {1 / (position * position), 1 / (position * position), 1 / (yaw * yaw)};
  double moved[3] = {};
  for (int step = 0; step < max_steps; ++step) {
    double matrix[3][3] = {{prior[0], 0, 0}, {0, prior[1], 0}, {0, 0, prior[2]}};
    double vector[3] = {-prior[0] * moved[0], -prior[1] * moved[1], -prior[2] * moved[2]};
    const maps::Pose pose{sensor.x + moved[0], sensor.y + moved[1], sensor.yaw + moved[2]};
    const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
    for (std::size_t i = every / 2; i < all.size(); i += every) {
      const maps::Point towards = readings.direction(all[i].beam);
      const double x = all[i].range * (c * towards.x - s * towards.y),
                   y = all[i].range * (s * towards.x + c * towards.y);
      const Slope at = slope({pose.x + x, pose.y + y});
      const double row[3] = {at.x, at.y, at.y * x - at.x * y};
      const double ratio = at.distance / outlier, falloff = 1 / (1 + ratio * ratio);
      const double weight = falloff * falloff / noise;
      for (int j = 0; j < 3; ++j) {
        vector[j] -= weight * row[j] * at.distance;
        for (int k = 0; k < 3; ++k) matrix[j][k] += weight * row[j] * row[k];
      }
    }
    if (!solve(matrix, vector)) break;
    for (int j = 0; j < 3; ++j) moved[j] += vector[j];
    if (std::abs(vector[0]) + std::abs(vector[1]) < 1e-4 && std::abs(vector[2]) < 1e-5) break;
  }
  // A larger correction than the largest error of the pose is rejected.
  if (!(std::hypot(moved[0], moved[1]) <= 5 * position) || !(std::abs(moved[2]) <= 5 * yaw)) return sensor;
  return {sensor.x + moved[0], sensor.y + moved[1], sensor.yaw + moved[2]};
}

}  // namespace slalom::tracking
