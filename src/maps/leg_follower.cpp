#include "slalom/maps/leg_follower.hpp"

#include <algorithm>

namespace slalom::maps {
namespace {

constexpr double turn_done = 0.2;   // rad from the end of a turn, at which it is finished
constexpr double settled = 0.5;     // s of standing near the end of a leg, after which it is finished
constexpr double tolerance = 0.01;  // m of room that a vehicle on a leg may lack

}  // namespace

LegOptions LegOptions::of(double length, double curvature) {
  const double scale = body_scale(length), root = std::sqrt(scale);
  return {.near = 0.04 * scale,
          .beside = 0.15 * scale,
          .standing = 0.08 * root,
          .standing_turn = 0.05,
          .forwards = 0.8 * root,
          .backwards = 0.5 * root,
          .braking = 1.2,
          .curvature = curvature,
          .look_ahead = 0.3 * scale};
}

void LegFollower::begin(const Pose& vehicle, double turn) noexcept {
  standing_ = 0;
  turn_left_ = turn;
  last_yaw_ = vehicle.yaw;
}

void LegFollower::advance(PathCurve& path, const Pose& vehicle, const Rates& rates, double period) noexcept {
  path.advance({vehicle.x, vehicle.y});
  if (path.leg().turns) turn_left_ -= wrap_angle(vehicle.yaw - last_yaw_);
  last_yaw_ = vehicle.yaw;
  speed_ = std::abs(rates.speed);
  const bool stands = speed_ < options_.standing && std::abs(rates.turn) < options_.standing_turn;
  standing_ = stands ? standing_ + period : 0;
}

/// The distance (m) that is left to the end of a leg, in its direction there.
double LegFollower::along(const PathCurve& path, const Pose& vehicle) const noexcept {
  const PathLeg& leg = path.leg();
  const Pose& end = path.points()[leg.last];
  const double yaw = path.points()[leg.last - 1].yaw,
               left = (end.x - vehicle.x) * std::cos(yaw) + (end.y - vehicle.y) * std::sin(yaw);
  return leg.backward ? -left : left;
}

bool LegFollower::is_finished(const PathCurve& path, const Pose& vehicle) const noexcept {
  const PathLeg& leg = path.leg();
  if (leg.turns) return std::abs(turn_left_) < turn_done;
  if (options_.stops && !path.on_last_leg() && speed_ >= options_.standing) return false;
  const Pose& end = path.points()[leg.last];
  const double away = distance({vehicle.x, vehicle.y}, {end.x, end.y}), near = options_.near;
  if (away <= near) return true;
  if (options_.stops && path.nearest() == leg.last && along(path, vehicle) <= 0) return true;
  return away <= options_.beside ? along(path, vehicle) <= 0.5 * near || standing_ > settled
                                 : away <= 5 * near && standing_ > 2 * settled && !path.on_last_leg();
}

std::optional<LegFollower::Command> LegFollower::command(const PathCurve& path, const Pose& vehicle,
                                                         double speed, double curvature,
                                                         const BodyRoom& room) const noexcept {
  const PathLeg& leg = path.leg();
  const double way = leg.backward ? -1 : 1;
  const auto local = [&](std::size_t i) {
    const Pose &point = path.points()[i], &before = path.points()[i > leg.first ? i - 1 : i];
    const Point at = inverse_transform(vehicle, {point.x, point.y});
    return Pose{at.x, at.y, before.yaw + 0.5 * wrap_angle(point.yaw - before.yaw) - vehicle.yaw};
  };
  if (std::abs(local(path.nearest()).y) > options_.beside) return std::nullopt;
  // Where it begins too near to an obstacle, it may leave it.
  const double usual = std::min(room.at({}), -tolerance);
  const std::size_t ahead = path.nearest() + path.points_for(options_.look_ahead);
  for (std::size_t i = path.nearest() + 1; i <= leg.last; ++i)
    if (room.at(local(i)) < (i < ahead ? usual : -tolerance)) return std::nullopt;
  double left = std::max(along(path, vehicle), 0.0);
  if (leg.last > path.nearest()) left = std::max(left, path.step() * (leg.last - path.nearest() - 1.0));
  if (path.on_last_leg() && !leg.backward) left += options_.look_ahead;  // it drives on
  const Pose aim = local(std::min(ahead - 1, leg.last));
  const double square = aim.x * aim.x + aim.y * aim.y, least = options_.look_ahead / 3;
  double wanted = curvature;
  if (square > least * least)
    wanted = std::clamp(2 * aim.y / square, -options_.curvature, options_.curvature);
  // The vehicle may be beside the leg, where there is less room.
  for (const double share : {1.0, 2.0}) {
    const double driven = way * share * least, turned = driven * wanted;
    if (std::abs(driven) > left) break;
    const Pose next{driven * std::cos(0.5 * turned), driven * std::sin(0.5 * turned), turned};
    if (room.at(next) >= usual) continue;
    if (std::abs(speed) < options_.standing) return std::nullopt;
    return Command{wanted, 0};
  }
  if (left == 0) return Command{wanted, 0};
  const double fastest = leg.backward ? options_.backwards : options_.forwards;
  const double creep = 0.75 * options_.standing;
  return Command{wanted, way * std::min(fastest, std::sqrt(2 * options_.braking * left) + creep)};
}

}  // namespace slalom::maps
