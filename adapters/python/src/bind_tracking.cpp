#include "driving.hpp"
#include "slalom/tracking/people.hpp"
#include "slalom/tracking/predictor.hpp"

namespace slalom::python {
namespace {

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
  const auto count = static_cast<py::ssize_t>(weights.size());
  if (poses.ndim() != 3 || poses.shape(2) != 5 || poses.shape(0) != count || poses.shape(1) < 1 ||
      count < 1 || count > maps::PredictedObstacle::max_hypotheses)
    throw py::value_error("PredictedObstacle.poses: must have shape (n, times, 5), with n weights, 1 to 4");
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
      "Something that moves: of an ObjectTracker, or of a detector of your own. `id`: stays with it.");
  object.def(py::init([](int id, const std::array<double, 3>& pose, double speed, double yaw_rate,
                         double length, double width, const Covariance& covariance) {
               TrackedObject made{id, to_pose(pose), speed, yaw_rate, length, width};
               std::memcpy(made.covariance, covariance.data(), sizeof made.covariance);
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

  py::class_<Prediction> predicted(
      module, "PredictedObstacle", guarded(),
      "A box that moves, in hypotheses with probabilities `weights`. `poses` [hypothesis, time, 5]: x, y, "
      "yaw, and standard deviations along and across it (m, rad), now and every `interval` s.");
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
  const std::string words =
      "Follows moving objects from scan to scan of a LiDAR: what is not on `map`, an OccupancyGrid, or "
      "without one what moves. `people`: with the options for people on foot. Other options:\n\n" +
      options_text(tracking::TrackerOptions{});
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
          "pose"_a, "stamp"_a, "position_deviation"_a = 0.0, "yaw_deviation"_a = 0.0,
          "Takes a scan at `stamp` (s). `pose`: (x, y, yaw) of the LiDAR, with its standard deviations (m, "
          "rad). Returns status, objects (TrackedObject) and pose, aligned with the map.")
      .def("reset", &ObjectTracker::reset, "Forgets all objects and scans.");
}

void bind_predictor(py::module_& module) {
  const std::string words =
      "Predicts the ways of moving objects, in hypotheses with weights. `course`: points (x, y, yaw, speed) "
      "of a line that they follow. `people`: with the options for people on foot. Other options:\n\n" +
      options_text(tracking::PredictorOptions{});
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
            std::vector<Prediction> all;
            for (const maps::PredictedObstacle& each : self.update(objects, stamp))
              all.push_back({each, {each.poses.begin(), each.poses.end()}});
            return all;
          },
          "objects"_a, "stamp"_a,
          "Returns a PredictedObstacle for each object that moves, for `others` of a Planner or a Navigator. "
          "`objects`: as they are at `stamp` (s).")
      .def("reset", &Predictor::reset, "Forgets all objects.");
}

}  // namespace

void bind_tracking(py::module_& module) {
  bind_objects(module);
  bind_tracker(module);
  bind_predictor(module);
}

}  // namespace slalom::python
