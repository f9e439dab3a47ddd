#include "slalom/vehicle/model/path_tracking.hpp"

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/vehicle/model/kinematic.hpp"

namespace slalom::vehicle {
namespace {

constexpr double most_checks = 1000;  // places of the body on its way between two states

/// The radius of three equal discs that cover the body's rectangle, m.
double disc_radius(const BodyOptions& options) {
  return std::hypot((options.front + options.rear) / 6, options.width / 2);
}

}  // namespace

TrackingCost::TrackingCost(const PathTrackingOptions& options)
    : options_(options.cost),
      localisation_less_(options.localisation_less),
      distance_weight_(options.cost.distance_weight),
      yaw_weight_(options.cost.yaw_weight),
      outside_cost_(options.cost.outside_cost),
      terminal_distance_weight_(options.cost.terminal_distance_weight),
      terminal_yaw_weight_(options.cost.terminal_yaw_weight),
      outside_terminal_cost_(options.cost.outside_terminal_cost),
      speed_weight_(options.cost.speed_weight),
      collision_weight_(options.cost.collision_weight) {}

void TrackingCost::set_conditions(const DrivingConditions& conditions) noexcept {
  way_ = conditions.reverse > 0 ? -1.0 : 1.0;
  fastest_ = conditions.reverse > 0 ? conditions.reverse : 1e3;
  const bool passing = conditions.urgency == Urgency::passing;
  const double share = passing ? 0.1 : 1;
  const double time = passing ? 4 : conditions.urgency == Urgency::detour ? 10 : 1;
  distance_weight_ = share * options_.distance_weight;
  terminal_distance_weight_ = share * options_.terminal_distance_weight;
  speed_weight_ = time * options_.speed_weight;
}

ObstacleCost::ObstacleCost(const BodyOptions& options)
    : discs_(options.model == BodyModel::discs),
      radius_(disc_radius(options)),
      margin_(options.margin),
      soft_margin_(options.soft_margin) {
  const double length = options.front + options.rear;
  for (int i = 0; i < 3; ++i) disc_[i] = -options.rear + length * (2 * i + 1) / 6;
  set_margin_shares(1, 1);
  soft_cost_ = options.soft_margin > 0 ? options.soft_cost : 0;
}

void ObstacleCost::set_margin_shares(double margin, double soft) noexcept {
  collision_clearance_ = radius_ + margin * margin_;
  soft_end_ = radius_ + margin * margin_ + soft * soft_margin_;
  inverse_soft_margin_ = soft_margin_ > 0 ? 1 / (soft * soft_margin_) : 0;
}

double ObstacleCost::clearance_reach(const BodyOptions& options) {
  return disc_radius(options) + options.margin + options.soft_margin + 0.01;
}

void ObstacleCost::set_map(const GridView<1>& obstacles, const maps::Pose& robot) noexcept {
  obstacles_ = obstacles;
  robot_ = robot;
  const double c = std::cos(robot.yaw), s = std::sin(robot.yaw);
  to_local_[0] = c;
  to_local_[1] = s;
  to_local_[2] = -c * robot.x - s * robot.y;
  to_local_[3] = -s;
  to_local_[4] = c;
  to_local_[5] = s * robot.x - c * robot.y;
  for (int i = 0; i < 6; ++i) {
    const GridAxis& axis = i < 3 ? obstacles.rows_axis() : obstacles.columns_axis();
    to_cells_[i] = to_local_[i] * axis.scale + (i % 3 == 2 ? axis.offset : 0);
  }
}

double ObstacleCost::room(const maps::Pose& pose) const noexcept {
  const auto [x, y, yaw] = pose;
  if (!discs_) return in_map_frame(x, y, yaw) < 100 ? 0 : -1;
  const double c = std::cos(yaw), s = std::sin(yaw);
  const double clearance = min_clearance(
      to_local_[0] * x + to_local_[1] * y + to_local_[2], to_local_[3] * x + to_local_[4] * y + to_local_[5],
      to_local_[0] * c + to_local_[1] * s, to_local_[3] * c + to_local_[4] * s);
  return clearance - double(collision_clearance_);
}

// No point of a body of discs nears an obstacle by more than its own way. So each check clears a part of the
// way that is as long as the clearance left (conservative advancement: Mirtich, "Impulse-based dynamic
// simulation of rigid body systems", 1996), and at least half a cell. A limit bounds the time for any poses.
bool ObstacleCost::collides_before(const maps::Pose& from, const maps::Pose& to) const noexcept {
  const double x = to.x - from.x, y = to.y - from.y, turn = maps::wrap_angle(to.yaw - from.yaw);
  const double lever = discs_ ? std::max(std::abs(double(disc_[0])), std::abs(double(disc_[2]))) : 0;
  const double way = std::hypot(x, y) + lever * std::abs(turn);
  const double least = std::max(0.5 * obstacles_.resolution(), way / most_checks);
  double at = 0;  // m
  do {
    const double share = way > 0 ? at / way : 0,
                 left = room({from.x + share * x, from.y + share * y, from.yaw + share * turn});
    if (!(left >= 0)) return true;
    at += std::max(left, least);
  } while (at < way);
  return false;
}

SteeringActuator::SteeringActuator(const PathTrackingOptions& options, bool exact)
    : hold_(options.hold_first_input),
      held_steps_(hold_ ? saturate_cast<int>(std::ceil(options.dead_time / options.time_step)) : 0),
      lag_factor_(exact ? 1 - std::exp(-options.time_step / options.steer_time_constant)
                        : options.time_step / options.steer_time_constant) {}

SpeedPrediction::SpeedPrediction(const PathTrackingOptions& options)
    : model_(options.speed),
      limited_(options.limit_acceleration),
      time_step_(options.time_step),
      speed_gain_(options.max_acceleration * options.time_step),
      speed_loss_(options.max_deceleration * options.time_step),
      linear_loss_(options.max_deceleration * options.time_step),
      target_speed_(options.reference_speed) {}

KinematicBicycle::KinematicBicycle(const PathTrackingOptions& options)
    : speed_(options),
      steering_(options),
      time_step_(options.time_step),
      inverse_wheelbase_(1 / options.wheelbase()) {}

KinematicBicycle::State<double> KinematicBicycle::start(const VehicleStart& start,
                                                        double reference_speed) noexcept {
  speed_.set_target(reference_speed);
  return {start.pose.x, start.pose.y, start.pose.yaw, start.speed, start.steer, 0};
}

VehicleTraits traits_of(const PathTrackingOptions& options, bool plans_speed) {
  const bool discs = options.body.model == BodyModel::discs;
  return {.time_step = options.time_step,
          .dead_time = options.hold_first_input ? 0 : options.dead_time,
          .wheelbase = options.wheelbase(),
          .rear_length = options.rear_length,
          .max_acceleration = options.max_acceleration,
          .max_deceleration = options.max_deceleration,
          .body = options.body,
          .obstacles = {.map = discs ? ObstacleMap::clearance : ObstacleMap::inflated,
                        .reach = ObstacleCost::clearance_reach(options.body)},
          .speed = {.planned = plans_speed,
                    .unlimited_acceleration = !options.limit_acceleration,
                    .follows_path = !options.localisation_less,
                    .reference = options.reference_speed},
          .tyres = {}};
}

}  // namespace slalom::vehicle
