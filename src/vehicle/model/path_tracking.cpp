#include "slalom/vehicle/model/path_tracking.hpp"

#include <cmath>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/vehicle/model/kinematic.hpp"

namespace slalom::vehicle {

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
  VehicleTraits traits;
  traits.time_step = options.time_step;
  traits.wheelbase = options.wheelbase();
  traits.rear_length = options.rear_length;
  traits.dead_time = options.hold_first_input ? 0 : options.dead_time;
  traits.max_acceleration = options.max_acceleration;
  traits.max_deceleration = options.max_deceleration;
  traits.unlimited_acceleration = !options.limit_acceleration;
  traits.plans_speed = plans_speed;
  traits.follows_path = !options.localisation_less;
  traits.reference_speed = options.reference_speed;
  const bool discs = options.body.model == BodyModel::discs;
  traits.obstacle_map = discs ? ObstacleMap::clearance : ObstacleMap::inflated;
  traits.clearance_reach = ObstacleCost::clearance_reach(options.body);
  traits.body = options.body;
  return traits;
}

}  // namespace slalom::vehicle
