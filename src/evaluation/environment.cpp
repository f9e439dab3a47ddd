#include "slalom/evaluation/environment.hpp"

#include "evaluation/lap_rules.hpp"

namespace slalom::evaluation {
namespace {

/// m, the distance from a point to the next wall in a direction, at most `most`.
double distance_to_wall(const sim::Track& track, const maps::Point& from, double cosine, double sine,
                        double most) {
  const double min_step = 0.5 * track.grid().resolution;
  double distance = 0;
  while (distance < most) {
    const maps::Point at{from.x + distance * cosine, from.y + distance * sine};
    if (track.in_wall(at)) return distance;
    distance += std::max(track.distance_to_wall(at) - track.grid().resolution, min_step);
  }
  return most;
}

/// m, for each point of a path: the distance to the wall on its wider side, where a parked car can be passed.
std::vector<double> room_beside(const sim::Track& track, const std::vector<maps::Point>& path) {
  constexpr double most = 10;  // m
  std::vector<double> room;
  const std::size_t count = path.size();
  for (std::size_t i = 0; i < count; ++i) {
    const maps::Point &before = path[(i + count - 1) % count], &after = path[(i + 1) % count];
    const double yaw = std::atan2(after.y - before.y, after.x - before.x), c = std::cos(yaw),
                 s = std::sin(yaw);
    room.push_back(std::max(distance_to_wall(track, path[i], -s, c, most),
                            distance_to_wall(track, path[i], s, -c, most)));
  }
  return room;
}

/// Moves the start along the waypoints to the first place with room for the car, if at the first waypoint its
/// body would be in a wall. A start that course.yaml gives stays.
void find_start(Environment& environment) {
  constexpr double room = 0.1;  // m around the body at the new start
  const vehicle::Course& course = environment.course;
  const sim::CarParameters car;
  const auto in_wall = [&](const maps::Pose& pose, double margin) {
    return environment.track->collides_with_wall(
        {.pose = pose, .length = car.length + 2 * margin, .width = car.width + 2 * margin});
  };
  environment.start = course.start;
  if (!vehicle::starts_at_first_waypoint(course) || !in_wall(course.start, 0)) return;
  for (const vehicle::Waypoint& point : course.waypoints) {
    const maps::Pose pose{point.x, point.y, point.yaw};
    if (in_wall(pose, room)) continue;
    environment.start = pose;
    environment.start_moved = point.arc_length;
    return;
  }
}

}  // namespace

const char* name(Protocol protocol) {
  return protocol == Protocol::published ? "published" : "true";
}

Protocol protocol_named(std::string_view text) {
  if (text == "true") return Protocol::true_physics;
  if (text == "published") return Protocol::published;
  throw std::invalid_argument("evaluation: '" + std::string(text) + "' must be 'true' or 'published'");
}

sim::WorldOptions Environment::world_options() const {
  sim::WorldOptions options = rules_of(protocol).world_options();
  if (lidar) options.lidar = *lidar;
  return options;
}

std::shared_ptr<Environment> make_environment(vehicle::Course course, Protocol protocol) {
  auto environment = std::make_shared<Environment>();
  environment->protocol = protocol;
  environment->course = std::move(course);
  std::vector<maps::Point> points;
  for (const vehicle::Waypoint& point : environment->course.waypoints) {
    points.push_back({point.x, point.y});
    environment->path.push_back({point.x, point.y, point.yaw, point.speed});
  }
  maps::check_reference_path(environment->path);
  environment->track = std::make_shared<const sim::Track>(environment->course.map, sim::LapPath(points),
                                                          rules_of(protocol).outside_is_wall());
  environment->obstacle_room = room_beside(*environment->track, environment->course.obstacle_path);
  find_start(*environment);
  environment->timeout = environment->course.timeout.value_or(0);
  return environment;
}

std::shared_ptr<const Environment> load_environment(const std::filesystem::path& folder, Protocol protocol,
                                                    const std::vector<std::filesystem::path>& course_roots) {
  const LapRules& rules = rules_of(protocol);
  vehicle::Course course = vehicle::load_course(folder, rules.map_rule());
  vehicle::move_to_local_origin(course);
  auto environment = make_environment(std::move(course), protocol);
  rules.complete(*environment, folder, course_roots);
  return environment;
}

}  // namespace slalom::evaluation
