#include "slalom/sim/racing_opponent.hpp"

#include <algorithm>

#include "slalom/core/options.hpp"

namespace slalom::sim {
namespace {

constexpr double sight = 12,
                 widest = 4;             // m ahead and behind, and beside the path, in which other cars count
constexpr double room = 0.1;             // m, sideways from cars alongside
constexpr double lane_offset = 0.6;      // m from the line at most, of blocking and of random lanes
constexpr double blocking_reach = 4;     // m, within which a car behind is blocked
constexpr double side_acceleration = 4;  // m/s^2, about the largest of a change of lane
constexpr double shortest_stay = 1, longest_stay = 3;  // s, of an erratic driver in a lane
constexpr double slowest = 0.6;                     // least share of its speed that an erratic driver chooses
constexpr double look_step = 0.2;                   // m, from one look ahead to the next
constexpr double follow_gap = 0.4, headway = 0.5;   // m, s, to a car ahead
constexpr double pass_gap = 0.15;                   // m along the line, from when cars are alongside
constexpr double braking_lag = 0.1;                 // s, of the speed control
constexpr double accelerating_lag = 0.21;           // s, where it speeds up
constexpr double shortest_change = 1.2;             // m, of a change of lane
constexpr double far_off = 3;                       // m from the path, from where it is searched anew
constexpr double least_aim = 0.4, aim_time = 0.14;  // m, s: distance to the point that it steers for

}  // namespace

RacingOpponent::RacingOpponent(std::shared_ptr<const RacingLine> line, std::size_t car, OpponentDriver driver,
                               double speed_share, RandomKey key)
    : line_(std::move(line)), car_(car), driver_(driver), speed_share_(speed_share), random_(key) {
  if (!line_) throw std::invalid_argument("line: must not be null");
  slalom::detail::check("opponent", {"speed_share", "", "", 0.01, 1}, speed_share);
}

/// Finds the own place along the path and those of the other cars. The line knows the parked bodies.
void RacingOpponent::look(const World& world) {
  const CarState& own = world.state(car_);
  if (placed_) place_ = line_->path().project_near({own.x, own.y}, place_.segment, 2);
  if (!placed_ || place_.distance > far_off) place_ = line_->path().project({own.x, own.y, own.yaw});
  placed_ = true;
  speed_ = std::max(own.speed, 0.0);
  half_length_ = 0.5 * world.options().car.length;
  half_width_ = 0.5 * world.options().car.width;
  neighbours_.clear();
  for (std::size_t car = 0; car < world.cars(); ++car) {
    const Box box = world.outline(car);
    if (car == car_ || !world.on_track(car) || std::hypot(box.pose.x - own.x, box.pose.y - own.y) > sight)
      continue;
    const LapPath::Place place = line_->path().project_near({box.pose.x, box.pose.y}, place_.segment, sight);
    if (std::abs(place.offset) > widest) continue;
    const double turned = box.pose.yaw - line_->at(place.arc).yaw;
    const double c = std::abs(std::cos(turned)), s = std::abs(std::sin(turned));
    neighbours_.push_back({.gap = line_->between(place_.arc, place.arc),
                           .offset = place.offset,
                           .half_length = 0.5 * (box.length * c + box.width * s),
                           .half_width = 0.5 * (box.length * s + box.width * c),
                           .speed = world.state(car).speed * std::cos(turned)});
  }
}

/// Whether a car and the own one overlap along the line, or nearly so.
bool RacingOpponent::alongside(const Neighbour& other) const noexcept {
  return std::abs(other.gap) < other.half_length + half_length_ + pass_gap;
}

/// m left of the racing line, where this driver wants to be.
double RacingOpponent::wanted_lane(double time) {
  if (driver_ == OpponentDriver::erratic) {
    if (time >= random_until_) {
      random_lane_ = random_.uniform(-lane_offset, lane_offset);
      random_share_ = random_.uniform(slowest, 1);
      random_until_ = time + random_.uniform(shortest_stay, longest_stay);
    }
    return random_lane_;
  }
  if (driver_ != OpponentDriver::blocking) return 0;
  const Neighbour* behind = nullptr;
  for (const Neighbour& other : neighbours_) {
    if (alongside(other)) return lane_;
    if (other.gap > 0 || -other.gap > blocking_reach || other.speed <= 0) continue;
    if (!behind || other.gap > behind->gap) behind = &other;
  }
  if (!behind) return 0;
  const double offset = behind->offset - line_->at(place_.arc + behind->gap).offset;
  return std::clamp(offset, -lane_offset, lane_offset);
}

/// m left of the path, `ahead` (m) on the way into the lane.
double RacingOpponent::offset_at(double ahead) const noexcept {
  const RacingLine::Point at = line_->at(place_.arc + ahead), here = line_->at(place_.arc);
  const double from = place_.offset - here.offset, share = std::clamp(ahead / change_, 0.0, 1.0);
  double offset = at.offset + from + (lane_ - from) * share * share * (3 - 2 * share);
  for (const Neighbour& other : neighbours_) {
    if (!alongside(other)) continue;
    // A distance that is less than wanted already may stay as it is.
    const double apart = other.half_width + half_width_ + room;
    if (other.offset > place_.offset)
      offset = std::min(offset, std::max(other.offset - apart, place_.offset));
    else
      offset = std::max(offset, std::min(other.offset + apart, place_.offset));
  }
  return std::clamp(offset, at.least, at.most);
}

double RacingOpponent::wanted_speed() const noexcept {
  const double share = speed_share_ * random_share_;
  double speed = std::numeric_limits<double>::infinity();
  for (double ahead = 0; ahead <= braking_lag * speed_ + look_step; ahead += look_step)
    speed = std::min(speed, share * line_->at(place_.arc + ahead).speed);
  // The speed control lags where the profile rises.
  const double rise = line_->at(place_.arc + accelerating_lag * speed_).speed - line_->at(place_.arc).speed;
  speed += share * std::max(rise, 0.0);
  for (const Neighbour& other : neighbours_) {
    if (other.gap <= 0) continue;
    const double half_widths = other.half_width + half_width_;
    if (alongside(other) && std::abs(place_.offset - other.offset) >= half_widths) continue;
    if (std::abs(offset_at(other.gap) - other.offset) > half_widths + room) continue;
    const double gap = other.gap - other.half_length - half_length_ - follow_gap;
    speed = std::min(speed, std::max(other.speed + gap / headway, 0.0));
  }
  return speed;
}

Command RacingOpponent::command(const World& world) {
  look(world);
  lane_ = wanted_lane(world.time());
  // A cubic of length l has an acceleration of at most 6 |offset| (v / l)^2.
  const double aside = std::abs(lane_ + line_->at(place_.arc).offset - place_.offset);
  change_ = std::max(shortest_change, speed_ * std::sqrt(6 * aside / side_acceleration));
  const CarParameters& car = world.options().car;
  const double ahead = least_aim + aim_time * speed_;
  const RacingLine::Point at = line_->at(place_.arc + ahead);
  const maps::Point aim = at.beside(offset_at(ahead));
  const CarState& own = world.state(car_);
  const double c = std::cos(own.yaw), s = std::sin(own.yaw);
  const double dx = aim.x - (own.x - car.rear_length * c), dy = aim.y - (own.y - car.rear_length * s);
  const double sideways = c * dy - s * dx, squared = std::max(dx * dx + dy * dy, 1e-6);
  const double steer = std::atan(2 * car.wheelbase() * sideways / squared);
  return {std::clamp(steer, car.steer_min, car.steer_max), wanted_speed()};
}

}  // namespace slalom::sim
