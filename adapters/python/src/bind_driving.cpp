#include "driving.hpp"

#include <cmath>

#include "slalom/evaluation/lap.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/course/course.hpp"

namespace slalom::python {
namespace {

using evaluation::Environment;

/// `config`, a name or a file, or the classes' defaults where it is empty; then `{"section.option": value}`
/// or the options of the method itself.
vehicle::Configuration configure(const std::string& method, const std::string& config,
                                 const py::dict& options) {
  vehicle::Configuration configuration;
  solver_options(method);
  if (!config.empty()) {
    const Folders folders = folders_of(vehicle::configuration_roots, "configs");
    configuration = vehicle::load_configuration(vehicle::find_configuration(config, folders), folders);
  }
  for (const auto& [key, value] : options)
    vehicle::set_option(configuration, value_as<std::string>(key, "options"), text_of(value), method);
  return configuration;
}

/// Takes the options of the world, `{"world.friction": 0.7}`, out of `options` and sets them.
evaluation::LapSettings take_world_options(py::dict& options) {
  evaluation::LapSettings settings;
  py::dict others;
  for (const auto& [key, value] : options)
    if (!evaluation::set_world_option(settings, value_as<std::string>(key, "options"), text_of(value)))
      others[key] = value;
  options = others;
  return settings;
}

/// The results of a lap as a slalom.plot.Lap. `path`: x, y, yaw and speed at each control step.
py::dict lap_dict(const evaluation::LapResult& lap, const std::vector<std::array<double, 4>>& path,
                  const Environment& environment) {
  const auto solves = static_cast<py::ssize_t>(lap.solve_ms.size());
  const auto waypoints = rows_of(environment.path, [](const maps::ReferencePoint& point) {
    return std::array{point.x, point.y, point.yaw, point.speed};
  });
  const py::dict results("mean_sequence_cost"_a = lap.mean_sequence_cost(),
                         "solve_ms"_a = py::array_t<float>(solves, lap.solve_ms.data()),
                         "path"_a = rows_of(path, [](const auto& row) { return row; }),
                         "obstacles"_a = rows_of(lap.obstacles));
  visit_figures(lap,
                [&](const auto& value, const evaluation::Figure& figure) { results[figure.name] = value; });
  return py::module_::import("slalom.plot").attr("Lap")(results, waypoints);
}

py::dict output_dict(const vehicle::PlannerOutput& output) {
  const auto predicted = rows_of(output.predicted, [](const auto& state) {
    return std::array{state.pose.x, state.pose.y, state.pose.yaw, state.speed};
  });
  return py::dict("status"_a = vehicle::name(output.status), "steer"_a = output.command.steer,
                  "speed"_a = output.command.speed, "predicted"_a = predicted,
                  "tick_time"_a = output.tick_time, "corrections"_a = output.corrections);
}

void bind_planner(py::module_& module) {
  py::class_<vehicle::Planner>(module, "Planner", "Computes steering and speed from LiDAR scan and odometry.",
                               guarded())
      .def(py::init([](const Environment& environment, const std::string& method, const py::dict& options,
                       const std::string& config) {
             const auto configuration = configure(method, config, options);
             return vehicle::Planner(configuration.planner,
                                     vehicle::make_vehicle_model(configuration.vehicle), environment.path,
                                     vehicle::make_solver(configuration, method, 1));
           }),
           "course"_a, "method"_a = "svg_mppi", "options"_a = py::dict(), py::kw_only(), "config"_a = "")
      .def(
          "update",
          [](vehicle::Planner& self, const Ranges& ranges, double angle_min, double angle_increment,
             double range_min, double range_max, const std::array<double, 3>& pose, double speed,
             const vehicle::PoseCovariance& covariance, const std::vector<std::array<double, 2>>& obstacles,
             const std::optional<std::array<double, 3>>& imu, const std::vector<Prediction>& others,
             const std::optional<std::array<double, 2>>& obeyed, const std::optional<double>& goal_speed) {
            vehicle::PlannerInput input{
                .scan = scan_of(ranges, angle_min, angle_increment, range_min, range_max),
                .odometry = {.pose = to_pose(pose), .speed = speed, .covariance = covariance}};
            std::vector<maps::Point> points;
            for (const auto& [x, y] : obstacles) points.push_back({x, y});
            const std::vector<maps::PredictedObstacle> views = views_of(others);
            input.obstacles = points;
            input.others = views;
            if (imu) input.imu = ImuReading{(*imu)[0], (*imu)[1], (*imu)[2]};
            if (obeyed) input.obeyed = Command{(*obeyed)[0], (*obeyed)[1]};
            input.goal_speed = goal_speed;
            const vehicle::PlannerOutput* output = nullptr;
            {
              const py::gil_scoped_release unlock;
              output = &self.update(input);
            }
            return output_dict(*output);
          },
          "ranges"_a, py::kw_only(), "angle_min"_a, "angle_increment"_a, "range_min"_a = 0.0, "range_max"_a,
          "pose"_a, "speed"_a, "covariance"_a = vehicle::PoseCovariance{},
          "obstacles"_a = std::vector<std::array<double, 2>>{}, "imu"_a = py::none(),
          "others"_a = std::vector<Prediction>{}, "obeyed"_a = py::none(), "goal_speed"_a = py::none(),
          "The command for the next control period.")
      .def("reset", &vehicle::Planner::reset, "seed"_a = 0,
           "Discards all state and starts the random numbers from `seed`.");
}

void bind_laps(py::module_& module) {
  module.def(
      "courses", [] { return vehicle::course_names(course_folders()); }, "The names of the courses found.");
  module.def(
      "drive_lap",
      [](const std::shared_ptr<Environment>& environment, const std::string& method, std::uint64_t seed,
         int obstacles, py::dict options, const std::string& config) {
        evaluation::LapSettings settings = take_world_options(options);
        settings.obstacles = obstacles;
        const evaluation::LapSetup setup{environment, {configure(method, config, options), method}, settings};
        evaluation::LapResult lap;
        std::vector<std::array<double, 4>> path;
        {
          const py::gil_scoped_release unlock;
          lap = evaluation::run_lap(setup, seed, [&](const evaluation::ControlStep& step) {
            const sim::CarState& car = step.world.state(0);
            path.push_back({car.x, car.y, car.yaw, car.speed});
            check_signals();
          });
        }
        return lap_dict(lap, path, *environment);
      },
      "course"_a, "method"_a = "svg_mppi", py::kw_only(), "seed"_a = 0, "obstacles"_a = 0,
      "options"_a = py::dict(), "config"_a = "",
      "Drives one lap in lockstep, as `slalom eval` does. A notebook draws the results.");
}

}  // namespace

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
             "course"_a, "evaluation"_a = "true");
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
      "Simulated cars with LiDAR on a course. The defaults are those of evaluation 'true'." +
      options_text(list_options(default_options({})));
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
          "seed"_a, "cars"_a, "parked"_a = Poses{}, "Restarts the world.")
      .def(
          "step",
          [](sim::World& self, const std::vector<std::array<double, 2>>& commands, int steps) {
            if (commands.size() != self.cars())
              throw py::value_error("commands: has " + std::to_string(commands.size()) + ", must have " +
                                    std::to_string(self.cars()) + ", one for each car");
            if (steps < 0) throw py::value_error("steps: " + std::to_string(steps) + " must be at least 0");
            std::vector<slalom::Command> all;
            for (const auto& c : commands) {
              check_finite("commands", c);
              all.push_back({c[0], c[1]});
            }
            const py::gil_scoped_release unlock;
            for (int k = 0; k < steps; ++k) {
              self.step(all);
              if (k % 64 == 63) check_signals();
            }
          },
          "commands"_a, "steps"_a = 1, "Moves by time steps.")
      .def("observe", observe, "car"_a = 0, "The measurements of a car.");
  const auto read = reader(world);
  read("time", "s since the reset", &sim::World::time);
  read("cars", "number of cars that drive", [](const sim::World& w) { return w.cars(); });
  read("options", "the options in use, by name",
       [](const sim::World& w) { return values_of(list_options(w.options())); });
  read("time_step", "s", [](const sim::World& w) { return w.options().time_step; });
}

}  // namespace

void bind_world(py::module_& module) {
  bind_course(module);
  bind_simulated_world(module);
}

}  // namespace slalom::python

PYBIND11_MODULE(_driving, module) {
  module.doc() = "Courses, simulator and planner of cars, and the navigator of mobile robots.";
  pybind11::module_::import("slalom._slalom");  // registers the exceptions
  slalom::python::bind_world(module);
  slalom::python::bind_tracking(module);  // before the signatures that name its classes
  slalom::python::bind_planner(module);
  slalom::python::bind_laps(module);
  slalom::python::bind_navigation(module);
}
