// The speed profile of a course as a lap.

#include "slalom/core/option_access.hpp"
#include "slalom/evaluation/race.hpp"
#include "slalom/vehicle/course/speed_profile.hpp"

namespace slalom::evaluation {
namespace {

constexpr double min_speed = 0.1;  // m/s, as in vehicle::profile_time

/// A point of a speed profile.
struct ProfilePoint {
  double distance = 0;   ///< m from the start of the lap
  double speed = 0;      ///< m/s
  double curvature = 0;  ///< 1/m
};

ProfilePoint between(const ProfilePoint& a, const ProfilePoint& b, double distance) {
  const double share = (distance - a.distance) / (b.distance - a.distance);
  return {distance, a.speed + share * (b.speed - a.speed), a.curvature + share * (b.curvature - a.curvature)};
}

/// The profile of a course from a start to the distance `length`, which is once round a closed course.
std::vector<ProfilePoint> points_from(const vehicle::Course& course, const sim::LapPath& path,
                                      const maps::Pose& start, double length) {
  const vehicle::PathGeometry geometry = vehicle::path_geometry(path.points(), course.closed);
  const std::size_t count = path.size();
  const sim::LapPath::Place place = path.project(start);
  std::vector<ProfilePoint> points;
  double distance = course.waypoints[place.segment].arc_length - place.arc;
  for (std::size_t k = 0; k <= count; ++k) {
    const std::size_t i = (place.segment + k) % count;
    const ProfilePoint point{distance, course.waypoints[i].speed, geometry.curvature[i]};
    distance += geometry.step[i];
    if (points.empty() || point.distance <= 0) {
      points.assign(1, point);
      continue;
    }
    if (points.size() == 1 && points[0].distance < 0) points[0] = between(points[0], point, 0);
    points.push_back(point);
    if (point.distance >= length) break;
  }
  ProfilePoint& last = points.back();
  if (last.distance > length) {
    last = between(points[points.size() - 2], last, length);
  } else if (last.distance < length) {  // the point before the start, which may be the start itself
    points.push_back({length, points.front().speed, points.front().curvature});
  }
  return points;
}

/// Lowers speeds to those that a car reaches from rest at the first point.
void start_from_rest(std::vector<ProfilePoint>& points, double grip) {
  points.front().speed = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const ProfilePoint& before = points[i - 1];
    const double curvature = std::max(std::abs(before.curvature), std::abs(points[i].curvature));
    const double start = before.speed * before.speed, step = points[i].distance - before.distance;
    // The grip that turning leaves at the speed that the car would reach without turning.
    const double used = std::min(1.0, (start + 2 * grip * step) * curvature / grip);
    const double reached = std::sqrt(start + 2 * grip * std::sqrt(1 - used * used) * step);
    points[i].speed = std::min(points[i].speed, reached);
  }
}

}  // namespace

RacingLap profile_lap(const LapSetup& setup, bool standing, double grip) {
  if (!(grip > 0)) throw std::invalid_argument("grip: " + to_text(grip) + " must be above 0");
  const Environment& environment = *setup.environment;
  const double length = setup.length();
  const maps::Pose start = setup.start();
  auto points = points_from(environment.course, *environment.track->lap_path(), start, length);
  if (standing) start_from_rest(points, grip);
  RacingLap lap{.standing = standing};
  lap.samples.push_back({.distance = 0, .time = 0, .speed = points.front().speed});
  for (std::size_t i = 1; i < points.size(); ++i) {
    const ProfilePoint &a = points[i - 1], &b = points[i];
    const double step = b.distance - a.distance, speed = std::max(0.5 * (a.speed + b.speed), min_speed);
    lap.samples.push_back({.distance = b.distance,
                           .time = lap.time() + step / speed,
                           .speed = b.speed,
                           .longitudinal = (b.speed - a.speed) * speed / step,
                           .lateral = speed * speed * 0.5 * (a.curvature + b.curvature)});
  }
  lap.sector = sector_times(lap.samples, length);
  return lap;
}

}  // namespace slalom::evaluation
