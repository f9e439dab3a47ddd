#pragma once

#include <array>
#include <filesystem>

#include "keywords.hpp"
#include "slalom/evaluation/environment.hpp"
#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::python {

using Folders = std::vector<std::filesystem::path>;

/// The folders that `search` finds from the package's folder, then those above it: `what` in the source tree
/// that the package was built in, or share/slalom/`what` in the package or in its prefix.
Folders folders_of(Folders (*search)(const std::filesystem::path&), const char* what);
Folders course_folders();

/// Ranges of a scan, m.
using Ranges = py::array_t<float, py::array::c_style | py::array::forcecast>;
inline maps::LaserScanView scan_of(const Ranges& ranges, double angle_min, double angle_increment,
                                   double range_min, double range_max) {
  const std::span<const float> values(ranges.data(), static_cast<std::size_t>(ranges.size()));
  return {values, angle_min, angle_increment, range_min, range_max};
}

/// Poses are tuples in Python.
inline maps::Pose to_pose(const std::array<double, 3>& pose) {
  return {pose[0], pose[1], pose[2]};
}

/// An array [item][number] of the numbers that `numbers` returns for each item.
template <class Items, class Numbers>
py::array_t<double> rows_of(const Items& items, Numbers&& numbers) {
  constexpr auto columns = std::tuple_size_v<decltype(numbers(*items.begin()))>;
  py::array_t<double> all({static_cast<py::ssize_t>(items.size()), static_cast<py::ssize_t>(columns)});
  double* to = all.mutable_data();
  for (const auto& item : items)
    for (const double number : numbers(item)) *to++ = number;
  return all;
}

/// An array [pose][x, y, yaw].
inline py::array_t<double> rows_of(std::span<const maps::Pose> poses) {
  return rows_of(poses, [](const maps::Pose& pose) { return std::array{pose.x, pose.y, pose.yaw}; });
}

/// Throws ValueError that names `what` unless all numbers are finite.
inline void check_finite(const char* what, std::span<const double> numbers) {
  if (!std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); }))
    throw py::value_error(std::string(what) + ": must be finite");
}

/// The prediction of a moving obstacle, with its poses.
struct Prediction {
  maps::PredictedObstacle obstacle;
  std::vector<maps::PredictedPose> poses;
};
/// Views of predictions, which must outlive them.
inline std::vector<maps::PredictedObstacle> views_of(const std::vector<Prediction>& predictions) {
  std::vector<maps::PredictedObstacle> views;
  for (const Prediction& each : predictions) views.emplace_back(each.obstacle).poses = each.poses;
  return views;
}

void bind_navigation(py::module_& module);
void bind_tracking(py::module_& module);
void bind_world(py::module_& module);

}  // namespace slalom::python
