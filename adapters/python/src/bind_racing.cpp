#include <array>
#include <cmath>
#include <filesystem>
#include <optional>

#include "driving.hpp"
#include "slalom/maps/ros_map.hpp"
#include "slalom/vehicle/racing/race_course.hpp"

namespace slalom::python {

namespace {

using vehicle::RacingCar;
using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// An array [points, columns].
py::array_t<double> table(std::size_t points, std::size_t columns) {
  return py::array_t<double>({static_cast<py::ssize_t>(points), static_cast<py::ssize_t>(columns)});
}

RacingCar make_car(const std::string& name, const py::kwargs& changes) {
  RacingCar car =
      std::filesystem::is_regular_file(name) ? vehicle::load_racing_car(name) : vehicle::racing_car(name);
  const auto keys = vehicle::numbers_of(car);
  for (const auto& [key, value] : changes) {
    const auto wanted = key.cast<std::string>();
    bool found = wanted == "friction";
    if (found) vehicle::set_friction(car, value.cast<double>());
    for (const auto& [known, field] : keys)
      if (wanted == known) {
        *field = value.cast<double>();
        found = true;
      }
    if (!found) throw py::type_error("RacingCar: unknown keyword '" + wanted + "'");
  }
  vehicle::validate(car);
  return car;
}

py::dict to_dict(const vehicle::Raceline& line) {
  auto points = table(line.points.size(), 7);
  auto cells = points.mutable_unchecked<2>();
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const auto& p = line.points[i];
    const double row[] = {p.arc_length, p.x, p.y, p.yaw, p.curvature, p.speed, p.acceleration};
    for (py::ssize_t k = 0; k < 7; ++k) cells(static_cast<py::ssize_t>(i), k) = row[k];
  }
  py::dict result;
  result["points"] = points;
  result["time"] = line.time;
  result["length"] = line.length;
  result["closed"] = line.closed;
  result["curvature_limit"] = line.curvature_limit;
  return result;
}

py::dict raceline(const Points& centre_line, const RacingCar& car, bool closed, std::optional<double> step) {
  if (centre_line.ndim() != 2 || centre_line.shape(1) != 4)
    throw py::value_error("centre_line: must have the shape [points, 4]: x, y, width right, width left");
  const auto cells = centre_line.unchecked<2>();
  std::vector<maps::Point> points;
  std::vector<double> left, right;
  double length = 0;
  for (py::ssize_t i = 0; i < cells.shape(0); ++i) {
    points.push_back({cells(i, 0), cells(i, 1)});
    right.push_back(cells(i, 2));
    left.push_back(cells(i, 3));
    if (i > 0) length += std::hypot(cells(i, 0) - cells(i - 1, 0), cells(i, 1) - cells(i - 1, 1));
  }
  const double spacing = step.value_or(vehicle::centre_line_step(car, length));
  const auto corridor = vehicle::corridor_from_widths(points, left, right, closed, spacing);
  const auto line = [&] {
    const py::gil_scoped_release unlock;
    return vehicle::minimum_time_raceline(corridor, car);
  }();
  return to_dict(line);
}

py::array_t<double> racing_speeds(const Points& curvature, const Points& step, bool closed,
                                  const RacingCar& car) {
  const auto values = [](const Points& array) {
    return std::span<const double>(array.data(), static_cast<std::size_t>(array.size()));
  };
  const auto speeds = vehicle::racing_speeds(values(curvature), values(step), closed, car);
  return py::array_t<double>(static_cast<py::ssize_t>(speeds.size()), speeds.data());
}

py::dict race_course(const std::string& map, const RacingCar& car, const std::string& out,
                     const std::optional<std::array<double, 3>>& start, bool reverse) {
  vehicle::RaceCourseOptions options;
  options.reverse = reverse;
  if (start) options.start = maps::Pose{(*start)[0], (*start)[1], (*start)[2]};
  const auto course = [&] {
    const py::gil_scoped_release unlock;
    return vehicle::race_course(maps::load_ros_map(map), car, options);
  }();
  const std::string name = std::filesystem::absolute(out).lexically_normal().filename().string();
  if (!out.empty()) vehicle::save_race_course(course, out, {name, "", "slalom course"});
  auto lines = table(course.corridor.centre_line.size(), 4);
  auto cells = lines.mutable_unchecked<2>();
  for (std::size_t i = 0; i < course.corridor.centre_line.size(); ++i) {
    const auto& corridor = course.corridor;
    const double row[] = {corridor.centre_line[i].x, corridor.centre_line[i].y, corridor.right[i],
                          corridor.left[i]};
    for (py::ssize_t k = 0; k < 4; ++k) cells(static_cast<py::ssize_t>(i), k) = row[k];
  }
  py::dict result = to_dict(course.raceline);
  result["centre_line"] = lines;
  result["distance"] =
      py::array_t<double>(static_cast<py::ssize_t>(course.distance.size()), course.distance.data());
  result["start"] = py::make_tuple(course.start.x, course.start.y, course.start.yaw);
  result["notes"] = course.notes;
  return result;
}

}  // namespace

void bind_racing(py::module_& module) {
  py::class_<RacingCar>(
      module, "RacingCar",
      "What a raceline depends on of a car: a name (f1tenth, passenger) or a YAML file, and "
      "keywords that change it: friction, width, margin, wheelbase, max_steering, "
      "max_steering_rate, top_speed, lateral_acceleration, acceleration, braking, power.")
      .def(py::init(&make_car), py::arg("name") = RacingCar{}.name)
      .def_readonly("name", &RacingCar::name, "f1tenth, passenger, or that of the file")
      .def_readonly("width", &RacingCar::width, "m")
      .def_readonly("margin", &RacingCar::margin, "m")
      .def_property_readonly(
          "max_curvature", [](const RacingCar& car) { return vehicle::max_curvature(car); }, "1/m");
  module.def(
      "raceline", &raceline, py::arg("centre_line"), py::arg("car") = RacingCar{}, py::arg("closed") = true,
      py::arg("step") = py::none(),
      "The minimum-time line along a centre line [points, 4] of x, y, width right and width left, m. "
      "Returns a dict: points [n, 7] (s, x, y, yaw, curvature, speed, acceleration), time, length, closed, "
      "curvature_limit.");
  module.def(
      "racing_speeds", &racing_speeds, py::arg("curvature"), py::arg("step"), py::arg("closed") = true,
      py::arg("car") = RacingCar{},
      "The highest speeds, m/s, along a path of these curvatures, 1/m, and steps from point to point, m.");
  module.def(
      "race_course", &race_course, py::arg("map"), py::arg("car") = RacingCar{}, py::arg("out") = "",
      py::arg("start") = py::none(), py::arg("reverse") = false,
      "A course from a ROS map, as `slalom course`: the dict of raceline(), and centre_line [points, 4], "
      "distance (m from the line to the walls), start, notes. Writes a course folder if `out` is given.");
}

}  // namespace slalom::python
