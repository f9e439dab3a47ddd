#include <array>

#include "controller.hpp"
#include "slalom/evaluation/lap_runner.hpp"
#include "slalom/vehicle/course/course.hpp"

namespace slalom::python {

namespace {

using evaluation::Environment;

using Roots = std::vector<std::filesystem::path>;

/// Where a program in the package's folder looks, then what lies above it: `what` of the source tree it was
/// built in, or share/slalom/`what` of the prefix it was installed to.
Roots roots_of(Roots (*search)(const std::filesystem::path&), const char* what) {
  const auto file = py::module_::import("slalom").attr("__file__").cast<std::string>();
  const auto package = std::filesystem::weakly_canonical(file).parent_path();
  Roots roots = search(package);
  for (auto above = package; above.has_relative_path(); above = above.parent_path())
    for (const auto& house : {above / "share" / "slalom", above})
      if (std::filesystem::exists(house / "courses" / "known.yaml")) roots.push_back(house / what);
  return roots;
}
Roots course_roots() {
  return roots_of(vehicle::course_roots, "courses");
}

py::tuple to_tuple(const maps::Pose& pose) {
  return py::make_tuple(pose.x, pose.y, pose.yaw);
}

maps::Pose to_pose(const std::array<double, 3>& pose) {
  return {pose[0], pose[1], pose[2]};
}

std::shared_ptr<const Environment> load(const std::string& course, const std::string& evaluation) {
  const auto roots = course_roots();
  return evaluation::load_environment(vehicle::find_course(course, roots),
                                      evaluation::protocol_named(evaluation), roots);
}

/// `config`, a name or a file, or the classes' defaults where it is empty; then `{"section.option": value}`
/// or the options of the method itself.
vehicle::Configuration configure(const std::string& method, const std::string& config,
                                 const py::dict& options) {
  vehicle::Configuration configuration;
  solver_options(method);
  if (!config.empty()) {
    const Roots roots = roots_of(vehicle::configuration_roots, "configs");
    configuration = vehicle::load_configuration(vehicle::find_configuration(config, roots), roots);
  }
  for (const auto& [key, value] : options) {
    std::string text = py::isinstance<py::bool_>(value) ? (value.cast<bool>() ? "true" : "false")
                                                        : py::str(value).cast<std::string>();
    vehicle::set_option(configuration, key.cast<std::string>(), text, method);
  }
  return configuration;
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
  all["time"] = seen.time;
  all["ranges"] = view(seen.scan.ranges.data(), {static_cast<py::ssize_t>(seen.scan.ranges.size())}, self);
  all["angle_min"] = seen.scan.angle_min;
  all["angle_increment"] = seen.scan.angle_increment;
  all["range_min"] = seen.scan.range_min;
  all["range_max"] = seen.scan.range_max;
  all["contact"] = seen.collides();
  all["wall"] = seen.wall;
  if (const auto* laps = world.laps(car)) {
    all["laps"] = laps->laps();
    all["progress"] = laps->progress();
    all["lateral"] = laps->lateral();
  }
  return all;
}

void bind_world(py::module_& module) {
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
  py::class_<sim::World>(module, "World", "Simulated cars with LiDAR on a course.")
      .def(py::init([](const Environment& environment, double time_step, int beams, double noise) {
             sim::WorldOptions options = environment.world_options();
             options.time_step = time_step;
             options.lidar.beams = beams;
             options.lidar.noise = noise;
             options.lidar.rate = 0;
             return sim::World(options, environment.track);
           }),
           py::arg("course"), py::kw_only(), py::arg("time_step") = 0.005, py::arg("beams") = 1080,
           py::arg("noise") = 0.01)
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
          "time_step", [](const sim::World& w) { return w.options().time_step; }, "s");
}

py::dict lap_dict(const evaluation::LapResult& lap) {
  py::dict all;
  all["seed"] = lap.seed;
  all["finished"] = lap.finished;
  all["timeout"] = lap.timeout;
  all["contacts"] = lap.collisions;
  all["time"] = lap.time;
  all["steps"] = lap.steps;
  all["state_cost"] = lap.state_cost;
  all["collision_cost"] = lap.collision_cost;
  all["mean_sequence_cost"] = lap.mean_sequence_cost;
  all["mean_speed"] = lap.mean_speed;
  all["min_clearance"] = lap.min_clearance;
  all["solve_ms"] = py::array_t<float>(static_cast<py::ssize_t>(lap.solve_ms.size()), lap.solve_ms.data());
  return all;
}

void bind_planner(py::module_& module) {
  py::class_<vehicle::Planner>(module, "Planner", "Computes steering and speed from LiDAR scan and odometry.")
      .def(py::init([](const Environment& environment, const std::string& method, const py::dict& options,
                       const std::string& config) {
             const auto configuration = configure(method, config, options);
             return vehicle::Planner(configuration.planner,
                                     vehicle::make_vehicle_model(configuration.vehicle), environment.path,
                                     vehicle::make_solver(configuration, method, 1));
           }),
           py::arg("course"), py::arg("method") = "svg_mppi", py::arg("options") = py::dict(), py::kw_only(),
           py::arg("config") = "",
           "`config`: 'default', 'published' or a file; otherwise the defaults of the classes. `options`: "
           "{'samples': "
           "2000, 'planner.max_speed': 4, 'vehicle....': ...}")
      .def(
          "update",
          [](vehicle::Planner& self,
             const py::array_t<float, py::array::c_style | py::array::forcecast>& ranges, double angle_min,
             double angle_increment, double range_min, double range_max, const std::array<double, 3>& pose,
             double speed) {
            const maps::LaserScanView scan{{ranges.data(), static_cast<std::size_t>(ranges.size())},
                                           angle_min,
                                           angle_increment,
                                           range_min,
                                           range_max};
            const vehicle::PlannerOutput* output = nullptr;
            {
              const py::gil_scoped_release unlock;
              output = &self.update({scan, {to_pose(pose), speed}});
            }
            py::array_t<double> predicted(
                {static_cast<py::ssize_t>(output->predicted.size()), py::ssize_t{4}});
            auto rows = predicted.mutable_unchecked<2>();
            for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
              const auto& state = output->predicted[static_cast<std::size_t>(i)];
              rows(i, 0) = state.pose.x, rows(i, 1) = state.pose.y;
              rows(i, 2) = state.pose.yaw, rows(i, 3) = state.speed;
            }
            py::dict all;
            all["status"] = vehicle::name(output->status);
            all["steer"] = output->command.steer;
            all["speed"] = output->command.speed;
            all["predicted"] = predicted;
            all["tick_time"] = output->tick_time;
            all["corrections"] = output->corrections;
            return all;
          },
          py::arg("ranges"), py::kw_only(), py::arg("angle_min"), py::arg("angle_increment"),
          py::arg("range_min") = 0.0, py::arg("range_max"), py::arg("pose"), py::arg("speed"),
          "`pose`: (x, y, yaw) of the rear axle. Returns status, steer (rad), speed (m/s), predicted [n, 4], "
          "tick_time (s) and corrections, the number of values that the final check changed.")
      .def("reset", &vehicle::Planner::reset, py::arg("seed") = 0,
           "Discards all state and starts the random numbers from `seed`.");
  module.def(
      "drive_lap",
      [](const std::shared_ptr<Environment>& environment, const std::string& method, std::uint64_t seed,
         int obstacles, const py::dict& options, const std::string& config) {
        evaluation::LapSettings settings;
        settings.obstacles = obstacles;
        evaluation::LapRunner runner(environment, configure(method, config, options), method, settings);
        evaluation::LapResult lap;
        {
          const py::gil_scoped_release unlock;
          lap = runner.run(seed);
        }
        return lap_dict(lap);
      },
      py::arg("course"), py::arg("method") = "svg_mppi", py::kw_only(), py::arg("seed") = 0,
      py::arg("obstacles") = 0, py::arg("options") = py::dict(), py::arg("config") = "",
      "Drives one lap in lockstep and returns its results, as `slalom eval` does.");
}

}  // namespace

void bind_driving(py::module_& module) {
  bind_world(module);
  bind_planner(module);
  module.def(
      "courses", [] { return vehicle::course_names(course_roots()); }, "The names of the courses found.");
}

}  // namespace slalom::python
