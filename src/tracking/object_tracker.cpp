#include "slalom/tracking/object_tracker.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "tracking/association.hpp"
#include "tracking/free_space.hpp"
#include "tracking/map_background.hpp"
#include "tracking/readings.hpp"
#include "tracking/tracked.hpp"

namespace slalom::tracking {
namespace {

constexpr double max_deviation = 0.8;  // m, of the position of an object; beyond it the object is dropped
constexpr double max_pause = 1.0;      // s between scans, after which all objects are forgotten
constexpr double max_jump = 0.5;       // m, of the sensor beyond its largest way, after which they are, too
constexpr double max_behind_walls = 0.1;  // share of the readings; with more the pose is wrong
constexpr double min_gap = 2.5;  // gap, over the distance of neighbouring beams, where a cluster is split
constexpr double largest_object = 1.3;  // size over the largest diameter: a larger cluster is not an object
constexpr int max_scans_at_rest = 12;   // scans without a sign of motion, without a map
constexpr int max_splits = 4;           // times that a cluster is halved

}  // namespace

struct ObjectTracker::Implementation {
  Implementation(const maps::OccupancyGrid* map, const TrackerOptions& given)
      : options((validate_options(given, "tracker"), given)), readings(given.max_beams, given.max_range) {
    candidates.reserve(given.max_beams);
    owners.reserve(given.max_beams);
    clusters.reserve(given.max_beams);
    own.reserve(given.max_beams);
    objects.reserve(given.max_objects);
    reported.reserve(objects.capacity());
    if (map) {
      background = std::make_shared<const MapBackground>(*map);
    } else {
      free_space.emplace(given.max_beams);
    }
  }

  void forget() noexcept {
    objects.clear();
    started = false;
    if (free_space) free_space->clear();
    output = {};
  }

  bool detect(const TrackerInput& input) noexcept;
  void leave_out_large_clusters() noexcept;
  void correct() noexcept;
  void begin_objects() noexcept;
  void begin_object(std::size_t begin, std::size_t end, int splits) noexcept;
  bool moves(std::span<const Reading> part) const noexcept;
  bool seen_through(const Tracked& object) const noexcept;
  void remove_objects() noexcept;
  void report() noexcept;

  TrackerOptions options;
  Readings readings;
  std::shared_ptr<const MapBackground> background;  ///< null without a map
  std::optional<FreeSpace> free_space;
  ReservedVector<Reading> candidates;  ///< readings that may belong to objects
  ReservedVector<int> owners;          ///< object of each candidate, by index, or -1
  ReservedVector<Cluster> clusters;
  ReservedVector<Reading> own;  ///< the readings of one object
  ReservedVector<Tracked> objects;
  ReservedVector<TrackedObject> reported;
  int next_id = 1;
  bool started = false;
  double stamp = 0;
  maps::Pose last_sensor;
  TrackerOutput output;
};

/// Finds the readings that may belong to objects, and their clusters; false if the scan does not fit the map.
bool ObjectTracker::Implementation::detect(const TrackerInput& input) noexcept {
  output.sensor = input.sensor;
  if (background && (input.position_deviation > 0 || input.yaw_deviation > 0))
    output.sensor = background->align(readings, input.sensor, input.position_deviation, input.yaw_deviation,
                                      options.range_deviation);
  readings.place(output.sensor);
  candidates.clear();
  std::size_t behind_walls = 0;
  for (const Reading& reading : readings.all()) {
    if (background) {
      const double margin =
          options.wall_distance + 3 * options.range_deviation + options.wall_angle * reading.range;
      const double distance = background->distance(reading.point);
      behind_walls += distance < -2 * margin;
      if (distance <= margin) continue;
    }
    candidates.push_back(reading);
  }
  // Other cars hide walls, but let nobody look through them.
  if (behind_walls > max_behind_walls * readings.all().size()) return false;
  find_clusters(candidates, readings.increment(), options, clusters);
  if (free_space) {
    leave_out_large_clusters();
    free_space->find_left(readings, input.stamp, options.free_margin);
  }
  return true;
}

/// Removes clusters that are not objects, which without a map are most of the walls: an object that was
/// lost must not go on along one of them.
void ObjectTracker::Implementation::leave_out_large_clusters() noexcept {
  std::size_t kept_candidates = 0, kept_clusters = 0;
  for (const auto [begin, end] : clusters) {
    if (diameter({candidates.data() + begin, end - begin}) > largest_object * max_diameter(options)) continue;
    clusters[kept_clusters++] = {kept_candidates, kept_candidates + (end - begin)};
    for (std::size_t i = begin; i < end; ++i) candidates[kept_candidates++] = candidates[i];
  }
  candidates.resize(kept_candidates);
  clusters.resize(kept_clusters);
}

/// Corrects the objects with their readings.
void ObjectTracker::Implementation::correct() noexcept {
  associate(candidates, clusters, objects, options, owners);
  for (std::size_t k = 0; k < objects.size(); ++k) {
    own.clear();
    for (std::size_t i = 0; i < candidates.size(); ++i)
      if (owners[i] == static_cast<int>(k)) own.push_back(candidates[i]);
    if (own.size() >= 2) {
      objects[k].correct(options, readings, own, moves(own));
    } else {
      objects[k].miss(seen_through(objects[k]));
    }
  }
}

/// Whether readings belong to something that moves, as far as that must be known: without a map.
bool ObjectTracker::Implementation::moves(std::span<const Reading> part) const noexcept {
  if (!free_space) return true;
  // An object that appears behind something else has not moved there.
  const bool isolated =
      readings.ends_at(part.front().beam, -1, options.min_incidence, options.range_deviation) &&
      readings.ends_at(part.back().beam, 1, options.min_incidence, options.range_deviation);
  return free_space->moves(part, options.free_margin, isolated ? 2 * options.length : 0);
}

/// Whether most beams towards the predicted box go on behind it.
bool ObjectTracker::Implementation::seen_through(const Tracked& object) const noexcept {
  const maps::Pose pose = object.pose();
  const maps::Point middle = maps::inverse_transform(readings.sensor(), {pose.x, pose.y});
  const double distance = std::hypot(middle.x, middle.y), radius = 0.5 * object.width();
  if (distance <= radius) return false;
  const double bearing = std::atan2(middle.y, middle.x), half = std::asin(radius / distance);
  const int beams = std::clamp(saturate_cast<int>(2 * half / readings.increment()), 1, readings.beams());
  const double behind = distance + 0.5 * object.length();
  int through = 0, stopped = 0;
  for (int i = 0; i <= beams; ++i) {
    const int beam = readings.beam_at(bearing + half * (2.0 * i / beams - 1));
    if (beam < 0) continue;
    const double range = readings.range(beam);
    if (range == 0 || std::isinf(range)) continue;
    ++(range > behind ? through : stopped);
  }
  return through > 2 * stopped;
}

/// Begins an object with candidates [begin, end), or with the parts of it if it is too large for one.
void ObjectTracker::Implementation::begin_object(std::size_t begin, std::size_t end, int splits) noexcept {
  if (end - begin < static_cast<std::size_t>(options.min_points)) return;
  const std::span<const Reading> part(candidates.data() + begin, end - begin);
  const double size = diameter(part), most = max_diameter(options);
  if (size > most && splits < max_splits) {
    std::size_t cut = 0;
    double widest = min_gap;
    for (std::size_t i = 1; i < part.size(); ++i) {
      const Reading &a = part[i - 1], &b = part[i];
      const double step = std::min(a.range, b.range) * readings.increment() * (b.beam - a.beam);
      const double gap =
          (std::hypot(b.point.x - a.point.x, b.point.y - a.point.y) - 2 * options.range_deviation) / step;
      if (gap <= widest) continue;
      widest = gap;
      cut = i;
    }
    if (cut > 0) {
      begin_object(begin, begin + cut, splits + 1);
      begin_object(begin + cut, end, splits + 1);
      return;
    }
  }
  if (size > largest_object * most || size < 0.25 * options.width || objects.size() == objects.capacity())
    return;
  if (!moves(part)) return;
  objects.emplace_back(next_id++, options, readings, part);
}

/// Begins objects with the readings that belong to none, apart from those at the outline of one.
void ObjectTracker::Implementation::begin_objects() noexcept {
  const std::size_t old_count = objects.size();
  const auto is_new = [&](std::size_t i) {
    if (owners[i] >= 0) return false;
    for (std::size_t k = 0; k < old_count; ++k)
      if (objects[k].unseen() == 0 &&
          outline_distance(candidates[i].point, objects[k]) < options.gate * options.range_deviation)
        return false;
    return true;
  };
  for (const Cluster& cluster : clusters) {
    for (std::size_t i = cluster.begin; i < cluster.end;) {
      std::size_t end = i;
      while (end < cluster.end && is_new(end)) ++end;
      if (end > i) begin_object(i, end, 0);
      i = end + 1;
    }
  }
}

void ObjectTracker::Implementation::remove_objects() noexcept {
  const auto given_up = [&](const Tracked& object) {
    const int max_misses = object.confirmed() ? options.max_misses : 0;
    return !object.finite() || object.misses() > max_misses || object.at_rest() > max_scans_at_rest ||
           object.unseen() > options.max_unseen_time ||
           (!object.confirmed() && object.unseen() > 0.2 * options.max_unseen_time) ||
           (object.unseen() > 0 && object.position_variance() > max_deviation * max_deviation);
  };
  // Two objects cannot be in the same place: one is the double of the other.
  const auto doubles = [&](const Tracked& object, const Tracked& other) {
    const maps::Pose a = object.pose(), b = other.pose();
    if (std::hypot(a.x - b.x, a.y - b.y) > 0.8 * options.width) return false;
    if (object.confirmed() != other.confirmed()) return other.confirmed();
    return object.id() > other.id();
  };
  std::erase_if(objects, given_up);
  for (auto object = objects.begin(); object != objects.end();) {
    const bool twice = std::any_of(objects.begin(), objects.end(),
                                   [&](const Tracked& other) { return doubles(*object, other); });
    object = twice ? objects.erase(object) : object + 1;
  }
}

void ObjectTracker::Implementation::report() noexcept {
  reported.clear();
  for (Tracked& object : objects) {
    object.confirm(options, background ? 0 : options.min_speed);
    if (object.confirmed()) reported.push_back(object.object());
  }
  std::sort(reported.begin(), reported.end(),
            [](const TrackedObject& a, const TrackedObject& b) { return a.id < b.id; });
  output.objects = reported;
}

ObjectTracker::ObjectTracker(const TrackerOptions& options)
    : implementation_(std::make_unique<Implementation>(nullptr, options)) {}
ObjectTracker::ObjectTracker(const maps::OccupancyGrid& map, const TrackerOptions& options)
    : implementation_(std::make_unique<Implementation>(&map, options)) {}
ObjectTracker::~ObjectTracker() = default;
ObjectTracker::ObjectTracker(const ObjectTracker& other)
    : implementation_(std::make_unique<Implementation>(*other.implementation_)) {
  Implementation& own = *implementation_;
  own.output.objects = {own.reported.data(), own.output.objects.size()};
}
ObjectTracker& ObjectTracker::operator=(const ObjectTracker& other) {
  return *this = ObjectTracker(other);
}
ObjectTracker::ObjectTracker(ObjectTracker&&) noexcept = default;
ObjectTracker& ObjectTracker::operator=(ObjectTracker&&) noexcept = default;

void ObjectTracker::reset() noexcept {
  implementation_->forget();
  implementation_->next_id = 1;
}

const TrackerOptions& ObjectTracker::options() const noexcept {
  return implementation_->options;
}

const TrackerOutput& ObjectTracker::update(const TrackerInput& input) noexcept {
  const auto begin = std::chrono::steady_clock::now();
  Implementation& self = *implementation_;
  const auto finish = [&](TrackerStatus status) -> const TrackerOutput& {
    self.output.status = status;
    self.output.update_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return self.output;
  };
  if (!maps::is_plausible(input.sensor) || !std::isfinite(input.stamp))
    return finish(TrackerStatus::bad_pose);
  double elapsed = self.started ? input.stamp - self.stamp : 0;
  if (self.started && elapsed <= 0 && elapsed > -max_pause) return finish(TrackerStatus::stale);
  const double moved = std::hypot(input.sensor.x - self.last_sensor.x, input.sensor.y - self.last_sensor.y);
  // Also a clock that was set back, and a sensor that was placed elsewhere.
  if (std::abs(elapsed) > max_pause ||
      (self.started && moved > self.options.max_speed * elapsed + max_jump)) {
    self.forget();
    elapsed = 0;
  }
  self.started = true;
  self.stamp = input.stamp;
  self.last_sensor = input.sensor;
  for (Tracked& object : self.objects) object.predict(elapsed, self.options);
  TrackerStatus status = TrackerStatus::bad_scan;
  if (self.readings.set(input.scan)) status = self.detect(input) ? TrackerStatus::ok : TrackerStatus::misfit;
  if (status == TrackerStatus::ok) {
    self.correct();
    self.begin_objects();
    if (self.free_space) self.free_space->keep(self.readings, input.stamp);
  }
  self.remove_objects();
  self.report();
  return finish(status);
}

}  // namespace slalom::tracking
