#include "driving.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "world_keywords.hpp"

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

std::shared_ptr<const Environment> load(const std::string& course, const std::string& evaluation) {
  const auto folders = course_folders();
  return evaluation::load_environment(vehicle::find_course(course, folders),
                                      evaluation::protocol_named(evaluation), folders);
}

template <class T>
py::array view(const T* data, std::vector<py::ssize_t> shape, const py::object& owner) {
  py::array array(py::dtype::of<T>(), shape, data, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

py::dict observe(const py::object& self, std::size_t car) {
  const auto& world = self.cast<const sim::World&>();
  if (car >= world.cars()) throw py::index_error("car: must be less than the number of cars");
  const sim::Observation seen = world.observe(car);
  py::dict all;
  all["pose"] = to_tuple(seen.pose);
  all["speed"] = seen.speed;
  all["steer"] = seen.steer;
  all["yaw_rate"] = seen.yaw_rate;
  all["slip"] = seen.slip;
  all["time"] = seen.time;
  all["scan_time"] = seen.scan_time;
  all["sensor"] = to_tuple(seen.sensor);
  all["ranges"] = view(seen.scan.ranges.data(), {static_cast<py::ssize_t>(seen.scan.ranges.size())}, self);
  all["angle_min"] = seen.scan.angle_min;
  all["angle_increment"] = seen.scan.angle_increment;
  all["range_min"] = seen.scan.range_min;
  all["range_max"] = seen.scan.range_max;
  all["contact"] = seen.collides();
  all["wall"] = seen.wall;
  all["colliding"] = py::cast(std::vector<int>(seen.colliding.begin(), seen.colliding.end()));
  if (const auto* laps = world.laps(car)) {
    all["laps"] = laps->laps();
    all["progress"] = laps->progress();
    all["lateral"] = laps->lateral();
  }
  return all;
}

void bind_course(py::module_& module) {
  py::class_<Environment, std::shared_ptr<Environment>>(module, "Course", "A course prepared for driving.")
      .def(py::init([](const std::string& course, const std::string& evaluation) {
             return std::const_pointer_cast<Environment>(load(course, evaluation));
           }),
           py::arg("course"), py::arg("evaluation") = "true",
           "`course`: a name or a folder. `evaluation`: 'true' or 'published'.")
      .def_property_readonly(
          "name", [](const Environment& a) { return a.course.name; }, "of the course")
      .def_property_readonly(
          "length", [](const Environment& a) { return a.course.length; }, "m")
      .def_property_readonly(
          "start", [](const Environment& a) { return to_tuple(a.start); }, "x, y (m), yaw (rad)")
      .def_property_readonly(
          "waypoints",
          [](const Environment& a) {
            py::array_t<double> all({static_cast<py::ssize_t>(a.path.size()), py::ssize_t{4}});
            auto rows = all.mutable_unchecked<2>();
            for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
              const auto& p = a.course.waypoints[static_cast<std::size_t>(i)];
              rows(i, 0) = p.x, rows(i, 1) = p.y, rows(i, 2) = p.yaw, rows(i, 3) = p.speed;
            }
            return all;
          },
          "float64 [n, 4]: x, y (m), yaw (rad), speed (m/s)");
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

void bind_bodies(py::class_<sim::World>& world) {
  using Pose = std::array<double, 3>;
  world
      .def(
          "add_parked_car", [](sim::World& w, const Pose& pose) { return w.add_parked_car(to_pose(pose)); },
          py::arg("pose"), "Places a car that does not move at (x, y, yaw). Returns the number of the body.")
      .def(
          "add_box",
          [](sim::World& w, const Pose& pose, double length, double width) {
            return w.add_box({to_pose(pose), length, width});
          },
          py::arg("pose"), py::arg("length"), py::arg("width"),
          "Places a box, m, whose middle is at (x, y, yaw). Returns the number of the body.")
      .def(
          "add_disc",
          [](sim::World& w, double x, double y, double radius) {
            return w.add_disc({{x, y}, radius});
          },
          py::arg("x"), py::arg("y"), py::arg("radius"), "Places a disc, m. Returns the number of the body.")
      .def(
          "move_body", [](sim::World& w, int body, const Pose& pose) { w.move_body(body, to_pose(pose)); },
          py::arg("body"), py::arg("pose"), "Moves a parked car, box or disc to (x, y, yaw).")
      .def("remove_body", &sim::World::remove_body, py::arg("body"),
           "Takes a parked car, box or disc away; the numbers of later bodies fall by one.");
}

void bind_simulated_world(py::module_& module) {
  const std::string words =
      "Simulated cars with LiDAR on a course.\n\nKeyword arguments with the defaults of evaluation "
      "'true':\n\n" +
      options_text(default_options({}));
  py::class_<sim::World> world(module, "World", words.c_str());
  world
      .def(py::init([](const Environment& environment, const py::kwargs& keywords) {
             sim::WorldOptions options = default_options(environment);
             set_from_keywords(options, keywords, "World");
             return sim::World(options, environment.track);
           }),
           py::arg("course"))
      .def(
          "reset",
          [](sim::World& self, std::uint64_t seed, const std::vector<std::array<double, 3>>& cars,
             const std::vector<std::array<double, 3>>& parked) {
            std::vector<maps::Pose> starts, others;
            for (const auto& pose : cars) starts.push_back(to_pose(pose));
            for (const auto& pose : parked) others.push_back(to_pose(pose));
            self.reset(seed, starts, others);
          },
          py::arg("seed"), py::arg("cars"), py::arg("parked") = std::vector<std::array<double, 3>>{},
          "Restarts with driven cars at rest at `cars` and parked cars at `parked`, each (x, y, yaw).")
      .def(
          "step",
          [](sim::World& self, const std::vector<std::array<double, 2>>& commands, int steps) {
            std::vector<slalom::Command> all;
            for (const auto& c : commands) all.push_back({c[0], c[1]});
            sim::StepStatus status = sim::StepStatus::ok;
            {
              const py::gil_scoped_release unlock;
              for (int k = 0; k < steps; ++k) status = self.step(all);
            }
            if (status == sim::StepStatus::missing_command)
              throw py::value_error("commands: must have one for each car");
            if (status == sim::StepStatus::non_finite_command)
              throw py::value_error("commands: must be finite");
          },
          py::arg("commands"), py::arg("steps") = 1,
          "Moves by `steps` time steps; a command is (steering angle rad, speed m/s).")
      .def("observe", observe, py::arg("car") = 0,
           "The measurements of a car, by name; `ranges` is a view that the next step overwrites.")
      .def_property_readonly("time", &sim::World::time, "s since the reset")
      .def_property_readonly(
          "cars", [](const sim::World& w) { return w.cars(); }, "number of cars that drive")
      .def_property_readonly(
          "options",
          [](const sim::World& w) {
            py::dict all;
            for (const OptionEntry& entry : list_options(w.options()))
              all[entry.declaration.name] = to_python(entry.value);
            return all;
          },
          "the options in use, by name")
      .def_property_readonly(
          "time_step", [](const sim::World& w) { return w.options().time_step; }, "s");
  bind_bodies(world);
}

}  // namespace

void bind_world(py::module_& module) {
  bind_course(module);
  bind_simulated_world(module);
}

}  // namespace slalom::python
