#include "driving.hpp"

#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "slalom/maps/pose_limits.hpp"
#include "slalom/navigation/navigator.hpp"
#include "slalom/navigation/path_planner.hpp"
#include "slalom/tracking/people.hpp"
#include "slalom/tracking/predictor.hpp"

namespace slalom::python {
namespace {

using navigation::Costmap;
using navigation::Footprint;
using navigation::Navigator;

/// The rows of an array, each with 2 or 3 numbers.
std::vector<maps::Pose> poses_of(const Numbers& rows, const char* what, py::ssize_t columns) {
  if (rows.ndim() != 2 || rows.shape(1) != columns)
    throw py::value_error(std::string(what) + ": has shape " + shape_text(extents_of(rows)) +
                          ", must have shape (n, " + std::to_string(columns) + ")");
  std::vector<maps::Pose> poses;
  for (py::ssize_t i = 0; i < rows.shape(0); ++i)
    poses.push_back({rows.at(i, 0), rows.at(i, 1), columns == 3 ? rows.at(i, 2) : 0});
  return poses;
}

void bind_costmap(py::module_& module) {
  py::class_<Footprint>(module, "Footprint", guarded(), "The outline of a robot.")
      .def(py::init([](const Numbers& vertices) {
             std::vector<maps::Point> points;
             for (const maps::Pose& each : poses_of(vertices, "vertices", 2))
               points.push_back({each.x, each.y});
             return Footprint(points);
           }),
           "vertices"_a)
      .def_static("rectangle", &Footprint::rectangle, "front"_a, "rear"_a, "width"_a,
                  "A rectangle around the origin.");
  py::class_<Costmap>(module, "Costmap", guarded(),
                      "The distances from the cells of an OccupancyGrid to the nearest obstacle.")
      .def(py::init([](const maps::OccupancyGrid& grid, const std::string& unknown) {
             if (unknown != "obstacle" && unknown != "priced")
               throw py::value_error("Costmap.unknown: '" + unknown + "' must be one of obstacle, priced");
             Costmap made(
                 grid.width, grid.height, grid.resolution,
                 unknown == "priced" ? navigation::UnknownCells::priced : navigation::UnknownCells::obstacle);
             if (!made.update(grid)) throw py::value_error("Costmap.grid: its origin must have the yaw 0");
             return made;
           }),
           "grid"_a, py::kw_only(), "unknown"_a = "obstacle")
      .def(
          "update",
          [](Costmap& self, const maps::OccupancyGrid& grid,
             const std::optional<py::array_t<float, py::array::c_style | py::array::forcecast>>& prices) {
            std::span<const float> values;
            if (prices) values = {prices->data(), static_cast<std::size_t>(prices->size())};
            if (!self.update(grid, values))
              throw py::value_error(
                  "Costmap.update: grid and prices must have the size and resolution of the first grid, and "
                  "the grid the yaw 0");
          },
          "grid"_a, "prices"_a = py::none(), "Takes the cells of a grid, which may have moved.")
      .def("distance", &Costmap::distance, "x"_a, "y"_a,
           "The distance from a position to the nearest obstacle.")
      .def(
          "collides",
          [](const Costmap& self, const Footprint& footprint, const std::array<double, 3>& pose) {
            return self.collides(footprint, to_pose(pose));
          },
          "footprint"_a, "pose"_a, "Whether the body overlaps an obstacle at a pose.");
  module.def(
      "plan_path",
      [](const Costmap& costmap, const Footprint& footprint, const std::array<double, 3>& start,
         const std::array<double, 3>& goal) {
        return rows_of(navigation::plan_path(costmap, footprint, to_pose(start), to_pose(goal)));
      },
      "costmap"_a, "footprint"_a, "start"_a, "goal"_a, "The cheapest path between two poses.");
}

/// A term of the cost that is a function in Python.
struct PythonCost {
  py::function function;
  std::exception_ptr error{};  ///< raised by the last call

  void add(const navigation::RolloutStates& states, std::span<double> costs) noexcept {
    const py::gil_scoped_acquire lock;
    if (error) return;
    try {
      const Numbers term =
          function(array_of(states.x), array_of(states.y), array_of(states.yaw), array_of(states.forward),
                   array_of(states.left), array_of(states.turn), states.step);
      const auto count = static_cast<py::ssize_t>(costs.size());
      if (term.size() != 1 && (term.ndim() != 1 || term.size() != count))
        throw py::value_error("Navigator.set_cost: the function returned shape " +
                              shape_text(extents_of(term)) + ", must return one number, or shape (" +
                              std::to_string(count) + ",)");
      for (py::ssize_t i = 0; i < count; ++i)
        costs[static_cast<std::size_t>(i)] += term.data()[term.size() == 1 ? 0 : i];
    } catch (...) {
      error = std::current_exception();
    }
  }
};

/// A navigator that keeps its cost's errors.
struct PythonNavigator : Navigator {
  using Navigator::Navigator;
  void set_term(const py::object& function) {
    cost = function.is_none() ? nullptr : std::make_shared<PythonCost>(PythonCost{py::function(function)});
    set_cost({});
    if (cost) set_cost([term = cost](const auto& states, auto costs) { term->add(states, costs); });
  }
  void check_term() const {
    if (cost && cost->error) std::rethrow_exception(std::exchange(cost->error, nullptr));
  }
  void each_object(const auto& visit) {
    if (cost) visit(&cost->function);
  }
  std::shared_ptr<PythonCost> cost;
};

void bind_navigator(py::module_& module) {
  const std::string words =
      "Drives a mobile robot along a path to a goal, between the obstacles of a costmap." +
      options_text(list_options(navigation::NavigatorOptions{}));
  py::class_<PythonNavigator>(module, "Navigator", words.c_str(), collected<PythonNavigator>())
      .def(py::init([](const Footprint& footprint, const Costmap& costmap, const std::string& method,
                       const py::dict& solver, const py::kwargs& options) {
             navigation::NavigatorOptions set;
             set_from_keywords(set, options, "Navigator");
             SolverOptions of_solver = navigation::method_options(method, set.base);
             set_from_keywords(of_solver, py::reinterpret_borrow<py::kwargs>(solver), method);
             return PythonNavigator(footprint, set, of_solver, costmap);
           }),
           "footprint"_a, "costmap"_a, py::kw_only(), "method"_a = "svg_mppi", "solver"_a = py::dict())
      .def(
          "set_path",
          [](PythonNavigator& self, const Numbers& path) { self.set_path(poses_of(path, "path", 3)); },
          "path"_a, "Follows a path (docs/navigation.md).")
      .def(
          "update",
          [](PythonNavigator& self, const std::array<double, 3>& pose, const std::array<double, 3>& velocity,
             const Costmap& costmap, double elapsed, const std::vector<Prediction>& others) {
            const std::vector<maps::PredictedObstacle> views = views_of(others);
            navigation::NavigationResult result;
            {
              const py::gil_scoped_release unlock;
              result = self.update(to_pose(pose), {velocity[0], velocity[1], velocity[2]}, costmap, elapsed,
                                   views);
            }
            self.check_term();
            const navigation::Velocity& command = result.command;
            return py::dict("status"_a = navigation::name(result.status),
                            "command"_a = py::make_tuple(command.forward, command.left, command.turn),
                            "remaining"_a = result.remaining, "delay"_a = result.delay,
                            "plan"_a = rows_of(result.plan), "path"_a = rows_of(result.path));
          },
          "pose"_a, "velocity"_a, "costmap"_a, "elapsed"_a, "others"_a = std::vector<Prediction>{},
          "The command for the next control period.")
      .def("set_cost", &PythonNavigator::set_term, "function"_a,
           "Adds a term of your own to the cost of plans.")
      .def(
          "reset", [](PythonNavigator& self, std::uint64_t seed) { self.reset(seed); }, "seed"_a = 0,
          "Forgets the path, and starts the random numbers from `seed`.");
}

using tracking::ObjectTracker;
using tracking::Predictor;
using tracking::TrackedObject;
using Covariance = std::array<std::array<double, 5>, 5>;

/// Options of a class, or those of people on foot, with what the keywords change.
template <class Options>
Options options_of(bool people, const Options& of_people, const py::kwargs& keywords, const char* where) {
  Options options = people ? of_people : Options{};
  set_from_keywords(options, keywords, where);
  return options;
}

Prediction make_prediction(const Numbers& poses, double length, double width, double interval,
                           const std::vector<double>& weights, int id) {
  const auto count = static_cast<py::ssize_t>(weights.size()), axes = poses.ndim();
  if (axes < 2 || axes > 3 || (axes == 3 ? poses.shape(0) : 1) != count || poses.shape(axes - 1) != 5 ||
      poses.shape(axes - 2) < 1 || count < 1 || count > maps::PredictedObstacle::max_hypotheses)
    throw py::value_error("PredictedObstacle.poses: shape must be (times, 5) or (1 to 4 weights, times, 5)");
  check_finite("PredictedObstacle.poses", {poses.data(), static_cast<std::size_t>(poses.size())});
  check_finite("PredictedObstacle.weights", weights);
  check_finite("PredictedObstacle: length, width, interval", std::array{length, width, interval});
  if (interval <= 0) throw py::value_error("PredictedObstacle.interval: must be positive");
  Prediction made;
  maps::PredictedObstacle& each = made.obstacle;
  each.id = id, each.length = length, each.width = width, each.interval = interval;
  each.hypotheses = static_cast<int>(count);
  std::copy(weights.begin(), weights.end(), each.weights.begin());
  for (const double* at = poses.data(); at < poses.data() + poses.size(); at += 5)
    made.poses.push_back({{at[0], at[1], at[2]}, at[3], at[4]});
  return made;
}

void bind_objects(py::module_& module) {
  py::class_<TrackedObject> object(
      module, "TrackedObject", guarded(),
      "Something that moves: of an ObjectTracker, or of a detector of your own.");
  object.def(py::init([](int id, const std::array<double, 3>& pose, double speed, double yaw_rate,
                         double length, double width, const Covariance& covariance) {
               TrackedObject made{id, to_pose(pose), speed, yaw_rate, length, width};
               std::memcpy(made.covariance, covariance.data(), sizeof made.covariance);
               maps::check_pose("TrackedObject.pose", made.pose);
               check_finite("TrackedObject: sizes and speeds", std::array{length, width, speed, yaw_rate});
               if (std::min({length, width, speed}) < 0)
                 throw py::value_error(
                     "TrackedObject: length, width and speed must be at least 0; who moves "
                     "backwards has the yaw of the motion");
               check_finite("TrackedObject.covariance", {&made.covariance[0][0], 25});
               return made;
             }),
             "id"_a, "pose"_a, py::kw_only(), "speed"_a, "yaw_rate"_a = 0.0, "length"_a = 0.5,
             "width"_a = 0.5, "covariance"_a = Covariance{});
  const auto read = reader(object);
  read("id", "from 1", [](const TrackedObject& o) { return o.id; });
  read("pose", "x, y (m), yaw (rad) of the middle of its box",
       [](const TrackedObject& o) { return to_tuple(o.pose); });
  read("speed", "m/s, along the yaw", [](const TrackedObject& o) { return o.speed; });
  read("yaw_rate", "rad/s", [](const TrackedObject& o) { return o.yaw_rate; });
  read("length", "m", [](const TrackedObject& o) { return o.length; });
  read("width", "m", [](const TrackedObject& o) { return o.width; });
  read("covariance", "[5, 5], of x, y, yaw, speed and yaw rate", [](const TrackedObject& o) {
    return py::array_t<double>({5, 5}, &o.covariance[0][0]);
  });
  read("unseen", "s since it was last seen", [](const TrackedObject& o) { return o.unseen; });

  py::class_<Prediction> predicted(module, "PredictedObstacle", guarded(),
                                   "A box that moves, in hypotheses.");
  predicted.def(py::init(&make_prediction), "poses"_a, py::kw_only(), "length"_a, "width"_a,
                "interval"_a = 0.1, "weights"_a = std::vector<double>{1}, "id"_a = 0);
  const auto read_of = reader(predicted);
  read_of("poses", "[hypothesis, time, 5]", [](const Prediction& p) {
    const int count = p.obstacle.hypotheses, times = static_cast<int>(p.poses.size()) / count;
    return py::array_t<double>({count, times, 5}, &p.poses[0].pose.x);
  });
  read_of("weights", "probabilities of the hypotheses", [](const Prediction& p) {
    return py::array_t<double>(p.obstacle.hypotheses, p.obstacle.weights.data());
  });
}

void bind_tracker(py::module_& module) {
  const std::string words = "Follows moving objects from scan to scan of a LiDAR." +
                            options_text(list_options(tracking::TrackerOptions{}));
  py::class_<ObjectTracker>(module, "ObjectTracker", words.c_str(), guarded())
      .def(
          py::init([](const std::optional<maps::OccupancyGrid>& map, bool people, const py::kwargs& options) {
            const auto set = options_of(people, tracking::people_tracker_options(), options, "ObjectTracker");
            return map ? ObjectTracker(*map, set) : ObjectTracker(set);
          }),
          "map"_a = py::none(), py::kw_only(), "people"_a = false)
      .def(
          "update",
          [](ObjectTracker& self, const Ranges& ranges, double angle_min, double angle_increment,
             double range_min, double range_max, const std::array<double, 3>& pose, double stamp,
             double position_deviation, double yaw_deviation) {
            const auto& seen = self.update({scan_of(ranges, angle_min, angle_increment, range_min, range_max),
                                            to_pose(pose), stamp, position_deviation, yaw_deviation});
            constexpr const char* statuses[] = {"ok", "bad_scan", "misfit", "bad_pose", "stale"};
            return py::dict("status"_a = statuses[static_cast<int>(seen.status)],
                            "objects"_a = std::vector(seen.objects.begin(), seen.objects.end()),
                            "pose"_a = to_tuple(seen.sensor));
          },
          "ranges"_a, py::kw_only(), "angle_min"_a, "angle_increment"_a, "range_min"_a = 0.0, "range_max"_a,
          "pose"_a, "stamp"_a, "position_deviation"_a = 0.0, "yaw_deviation"_a = 0.0, "Takes a scan.")
      .def("reset", &ObjectTracker::reset, "Forgets all objects and scans.");
}

void bind_predictor(py::module_& module) {
  const std::string words = "Predicts the ways of moving objects, in hypotheses with weights." +
                            options_text(list_options(tracking::PredictorOptions{}));
  py::class_<Predictor>(module, "Predictor", words.c_str(), guarded())
      .def(py::init([](const std::optional<std::vector<std::array<double, 4>>>& course, bool people,
                       const py::kwargs& options) {
             const auto set = options_of(people, tracking::people_predictor_options(), options, "Predictor");
             if (!course) return Predictor(set);
             std::vector<maps::ReferencePoint> line;
             for (const auto& [x, y, yaw, speed] : *course) line.push_back({x, y, yaw, speed});
             return Predictor(line, set);
           }),
           "course"_a = py::none(), py::kw_only(), "people"_a = false)
      .def(
          "update",
          [](Predictor& self, const std::vector<TrackedObject>& objects, double stamp) {
            check_finite("Predictor.update: stamp", {&stamp, 1});
            std::set<int> ids;
            for (const TrackedObject& each : objects)
              if (!ids.insert(each.id).second)
                throw py::value_error("Predictor.update: objects: the id " + std::to_string(each.id) +
                                      " must be that of one object");
            std::vector<Prediction> all;
            for (const maps::PredictedObstacle& each : self.update(objects, stamp))
              all.push_back({each, {each.poses.begin(), each.poses.end()}});
            return all;
          },
          "objects"_a, "stamp"_a, "Predicts the objects that move.")
      .def("reset", &Predictor::reset, "Forgets all objects.");
  module.def(
      "drop_readings_of",
      [](const std::vector<Prediction>& others, const Ranges& ranges, double angle_min,
         double angle_increment, const std::array<double, 3>& pose, double margin) {
        Ranges kept(ranges.size(), ranges.data());
        const std::span<float> values(kept.mutable_data(), static_cast<std::size_t>(kept.size()));
        const auto scan = scan_of(ranges, angle_min, angle_increment, 0, 0);
        for (const auto& each : views_of(others))
          maps::drop_readings_of(each, margin, to_pose(pose), scan, values);
        return kept;
      },
      "others"_a, "ranges"_a, py::kw_only(), "angle_min"_a, "angle_increment"_a, "pose"_a, "margin"_a = 0.15,
      "The ranges of a scan for a map that must not keep who moves.");
}

}  // namespace

void bind_navigation(py::module_& module) {
  bind_costmap(module);
  bind_navigator(module);
}

void bind_tracking(py::module_& module) {
  bind_objects(module);
  bind_tracker(module);
  bind_predictor(module);
}

}  // namespace slalom::python
