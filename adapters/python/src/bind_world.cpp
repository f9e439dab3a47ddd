#include <cmath>

#include "driving.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"

namespace slalom::python {

Folders folders_of(Folders (*search)(const std::filesystem::path&), const char* what) {
  const auto file = py::module_::import("slalom").attr("__file__").cast<std::string>();
  const auto package = std::filesystem::weakly_canonical(file).parent_path();
  Folders folders = search(package);
  for (auto above = package; above.has_relative_path(); above = above.parent_path())
    for (const auto& house : {above / "share" / "slalom", above})
      if (std::filesystem::exists(house / "courses" / "known.yaml")) folders.push_back(house / what);
  return folders;
}
Folders course_folders() {
  return folders_of(vehicle::course_roots, "courses");
}

namespace {

using evaluation::Environment;

py::dict observe(const py::object& self, std::size_t car) {
  const auto& world = self.cast<const sim::World&>();
  if (car >= world.cars()) throw py::index_error("car: must be less than the number of cars");
  const sim::Observation seen = world.observe(car);
  const maps::LaserScanView& scan = seen.scan;
  const py::array ranges(py::dtype::of<float>(), {static_cast<py::ssize_t>(scan.ranges.size())},
                         scan.ranges.data(), self);
  py::dict all("pose"_a = to_tuple(seen.pose), "speed"_a = seen.speed, "steer"_a = seen.steer,
               "yaw_rate"_a = seen.yaw_rate, "slip"_a = seen.slip, "time"_a = seen.time,
               "scan_time"_a = seen.scan_time, "sensor"_a = to_tuple(seen.sensor),
               "ranges"_a = read_only(ranges), "angle_min"_a = scan.angle_min,
               "angle_increment"_a = scan.angle_increment, "range_min"_a = scan.range_min,
               "range_max"_a = scan.range_max, "contact"_a = seen.collides(), "wall"_a = seen.wall,
               "colliding"_a = std::vector<int>(seen.colliding.begin(), seen.colliding.end()));
  if (const auto* laps = world.laps(car)) {
    all["laps"] = laps->laps();
    all["progress"] = laps->progress();
    all["lateral"] = laps->offset();
  }
  return all;
}

void bind_course(py::module_& module) {
  py::class_<Environment, std::shared_ptr<Environment>> course(module, "Course", guarded(),
                                                               "A course prepared for driving.");
  course.def(py::init([](const std::string& name, const std::string& evaluation) {
               const Folders folders = course_folders();
               return std::const_pointer_cast<Environment>(evaluation::load_environment(
                   vehicle::find_course(name, folders), evaluation::protocol_named(evaluation), folders));
             }),
             "course"_a, "evaluation"_a = "true",
             "`course`: a name or a folder. `evaluation`: 'true' or 'published'.");
  const auto read = reader(course);
  read("name", "of the course", [](const Environment& e) { return e.course.name; });
  read("length", "m", [](const Environment& e) { return e.course.length; });
  read("start", "x, y (m), yaw (rad)", [](const Environment& e) { return to_tuple(e.start); });
  read("waypoints", "float64 [n, 4]: x, y (m), yaw (rad), speed (m/s)", [](const Environment& e) {
    return rows_of(e.course.waypoints, [](const auto& w) { return std::array{w.x, w.y, w.yaw, w.speed}; });
  });
}

/// Options of the course's evaluation, but for the time step and the LiDAR of Python's default.
sim::WorldOptions default_options(const Environment& environment) {
  sim::WorldOptions options = environment.world_options();
  options.time_step = 0.005;
  options.lidar.beams = 1080;
  options.lidar.noise = 0.01;
  options.lidar.rate = 0;
  return options;
}

using Poses = std::vector<std::array<double, 3>>;

std::vector<maps::Pose> to_poses(const Poses& poses) {
  std::vector<maps::Pose> all;
  for (const auto& pose : poses) all.push_back(to_pose(pose));
  return all;
}

void bind_simulated_world(py::module_& module) {
  const std::string words =
      "Simulated cars with LiDAR on a course.\n\nKeyword arguments with the defaults of evaluation "
      "'true':\n\n" +
      options_text(default_options({}));
  py::class_<sim::World> world(module, "World", words.c_str(), guarded());
  world
      .def(py::init([](const Environment& environment, const py::kwargs& keywords) {
             sim::WorldOptions options = default_options(environment);
             set_from_keywords(options, keywords, "World");
             return sim::World(options, environment.track);
           }),
           "course"_a)
      .def(
          "reset",
          [](sim::World& self, std::uint64_t seed, const Poses& cars, const Poses& parked) {
            self.reset(seed, to_poses(cars), to_poses(parked));
          },
          "seed"_a, "cars"_a, "parked"_a = Poses{},
          "Restarts with driven cars at rest at `cars` and parked cars at `parked`, each (x, y, yaw).")
      .def(
          "step",
          [](sim::World& self, const std::vector<std::array<double, 2>>& commands, int steps) {
            if (commands.size() != self.cars())
              throw py::value_error("commands: has " + std::to_string(commands.size()) + ", must have " +
                                    std::to_string(self.cars()) + ", one for each car");
            if (steps < 0) throw py::value_error("steps: " + std::to_string(steps) + " must be at least 0");
            std::vector<slalom::Command> all;
            for (const auto& c : commands) {
              if (!std::isfinite(c[0]) || !std::isfinite(c[1]))
                throw py::value_error("commands: must be finite");
              all.push_back({c[0], c[1]});
            }
            const py::gil_scoped_release unlock;
            for (int k = 0; k < steps; ++k) {
              self.step(all);
              if (k % 64 == 63) check_signals();
            }
          },
          "commands"_a, "steps"_a = 1,
          "Moves by `steps` time steps; a command is (steering angle rad, speed m/s).")
      .def("observe", observe, "car"_a = 0,
           "The measurements of a car, by name; `ranges` is a view that the next step overwrites.");
  const auto read = reader(world);
  read("time", "s since the reset", &sim::World::time);
  read("cars", "number of cars that drive", [](const sim::World& w) { return w.cars(); });
  read("options", "the options in use, by name", [](const sim::World& w) { return values_of(w.options()); });
  read("time_step", "s", [](const sim::World& w) { return w.options().time_step; });
}

}  // namespace

void bind_world(py::module_& module) {
  bind_course(module);
  bind_simulated_world(module);
}

}  // namespace slalom::python
