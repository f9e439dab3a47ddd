#include "vehicle/planner/manoeuvre.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace slalom::vehicle::detail {
namespace {

constexpr double usable_steering = 0.85;  // share of the largest curvature of arcs; the rest corrects
constexpr double kept_share = 0.4;        // share of the margin that arcs keep

double largest_curvature(double wheelbase, double steer_limit) {
  return std::tan(std::min(steer_limit, 1.2)) / wheelbase;
}

maps::ManoeuvreOptions search_options(const BodyOptions& body, double wheelbase, double steer_limit) {
  maps::ManoeuvreOptions made = maps::ManoeuvreOptions::of(
      length_of(body), 1 / (usable_steering * largest_curvature(wheelbase, steer_limit)));
  made.beside = maps::body_scale(length_of(body));
  made.turned = 0.5;
  made.rear = body.rear;
  return made;
}

/// The room of a car's body of three discs on a map around it.
class CarRoom final : public maps::BodyRoom {
 public:
  CarRoom(const maps::ClearanceMap& obstacles, const BodyOptions& body)
      : obstacles_(obstacles),
        keep_(std::hypot(length_of(body) / 6, body.width / 2) + kept_share * body.margin) {
    for (int i = 0; i < 3; ++i) discs_[i] = -body.rear + length_of(body) * (2 * i + 1) / 6;
  }
  double at(const maps::Pose& pose) const noexcept override {
    const double cosine = std::cos(pose.yaw), sine = std::sin(pose.yaw);
    float least = std::numeric_limits<float>::infinity();
    for (const double disc : discs_)
      least = std::min(least, obstacles_.at(pose.x + disc * cosine, pose.y + disc * sine));
    return least > 0 ? static_cast<double>(least) - keep_ : -std::numeric_limits<double>::infinity();
  }

 private:
  const maps::ClearanceMap& obstacles_;
  double keep_;                    ///< m, of the discs' centres from obstacles
  std::array<double, 3> discs_{};  ///< m, centres ahead of the rear axle
};

}  // namespace

Manoeuvre::Manoeuvre(std::span<const maps::ReferencePoint> path, bool closed, const BodyOptions& body,
                     double wheelbase, double steer_limit)
    : course_(path.begin(), path.end()),
      closed_(closed),
      body_(body),
      wheelbase_(wheelbase),
      search_(search_options(body, wheelbase, steer_limit)),
      follower_(maps::LegOptions::of(length_of(body), largest_curvature(wheelbase, steer_limit))) {
  constexpr auto most = static_cast<double>(maps::ManoeuvreSearch::max_steps);
  way_.reserve(saturate_cast<std::size_t>(most * search_.options().step / maps::PathCurve::spacing) + 3);
  goals_.reserve(96);
  poses_.reserve(maps::ManoeuvreSearch::max_poses);
}

/// Collects the part of the path around the car at which a way may end, on both sides of the nearest point.
void Manoeuvre::find_goals(const maps::Pose& pose, std::size_t nearest, double ahead) noexcept {
  const double scale = maps::body_scale(length_of(body_)), reach = 4 * scale, spacing = 0.1 * scale;  // m
  const std::size_t count = course_.size();
  goals_.clear();
  for (const bool forward : {true, false}) {
    double way = 0, since = spacing;
    for (std::size_t k = 0, at = nearest; k < count && way < reach; ++k) {
      const maps::ReferencePoint& point = course_[at];
      if (since >= spacing && (forward ? way : -way) >= ahead && goals_.size() < goals_.capacity()) {
        const maps::Point local = maps::inverse_transform(pose, {point.x, point.y});
        goals_.push_back({{local.x, local.y, point.yaw - pose.yaw}});
        since = 0;
      }
      if (!closed_ && at == (forward ? count - 1 : 0)) break;
      at = (at + (forward ? 1 : count - 1)) % count;
      const double gap = std::hypot(course_[at].x - point.x, course_[at].y - point.y);
      way += gap;
      since += gap;
    }
  }
}

bool Manoeuvre::search(const maps::ClearanceMap& obstacles, const maps::Pose& pose, int nearest, double ahead,
                       double sight) noexcept {
  cancel();
  find_goals(pose, static_cast<std::size_t>(nearest), ahead);
  if (!search_.search(CarRoom(obstacles, body_), goals_, sight)) return false;
  poses_.clear();
  for (const maps::Pose& each : search_.poses()) {
    const maps::Point place = maps::transform(pose, {each.x, each.y});
    poses_.push_back({place.x, place.y, maps::wrap_angle(pose.yaw + each.yaw)});
  }
  way_.set(poses_, false);
  follower_.begin(pose);
  return true;
}

std::optional<Command> Manoeuvre::follow(const maps::ClearanceMap& obstacles, const maps::Pose& pose,
                                         double speed, double steer, double period) noexcept {
  follower_.update(way_, pose, {.speed = speed}, period, [] { return 0.0; });
  if (way_.on_last_leg() && follower_.is_finished(way_, pose)) {
    cancel();
    return std::nullopt;
  }
  const auto made =
      follower_.command(way_, pose, speed, std::tan(steer) / wheelbase_, CarRoom(obstacles, body_));
  if (!made) return std::nullopt;
  // The wheels need time to turn, so the car waits for them.
  const double wanted = std::atan(made->curvature * wheelbase_);
  return Command{wanted, made->speed * std::max(1 - 4 * std::abs(wanted - steer), 0.0)};
}

}  // namespace slalom::vehicle::detail
