#include "slalom/vehicle/published/path_tracking.hpp"

#include "slalom/vehicle/published/options.hpp"

namespace slalom::vehicle::published {

Bicycle::Bicycle(const PathTrackingOptions& options, const ModelOptions& own)
    : model_(own.bicycle),
      slip_from_command_(options.localisation_less && own.bicycle == BicycleModel::published),
      steering_(options, own.exact_lag),
      slip_ratio_(options.front_length / options.wheelbase()),
      inverse_length_(own.bicycle == BicycleModel::published ? 1 / options.rear_length
                                                             : 1 / options.wheelbase()) {}

OneTrajectory::OneTrajectory(const PathTrackingOptions& options, const ModelOptions& own)
    : options_(options),
      bicycle_(options, own),
      speed_(options),
      cost_(options),
      obstacles_(options.body),
      time_step_(options.time_step) {
  speed_.set_linear_loss((own.linear_sign_error ? -1 : 1) * options.max_deceleration * options.time_step);
}

OneTrajectory::State<double> OneTrajectory::start(const VehicleStart& start,
                                                  double reference_speed) noexcept {
  speed_.set_target(reference_speed);
  return {start.pose.x, start.pose.y, start.pose.yaw, start.speed, start.steer, 0};
}

PredictedState OneTrajectory::predicted(const State<double>& s) const noexcept {
  const maps::Pose& robot = obstacles_.robot();
  const maps::Point local = maps::inverse_transform(robot, {s.x, s.y});
  return {{s.x, s.y, s.yaw}, s.speed, s.steer, {local.x, local.y, s.yaw - robot.yaw}};
}

TwoTrajectories::State<double> TwoTrajectories::start(const VehicleStart& start,
                                                      double reference_speed) noexcept {
  speed_.set_target(reference_speed);
  const maps::Pose &robot = obstacles_.robot(), &at = start.pose;
  const maps::Point local = maps::inverse_transform(robot, {at.x, at.y});
  return {at.x, at.y, at.yaw, start.speed, start.steer, 0, local.x, local.y, at.yaw - robot.yaw, 0};
}

PredictedState TwoTrajectories::predicted(const State<double>& s) const noexcept {
  return {{s.x, s.y, s.yaw}, s.speed, s.steer, {s.local_x, s.local_y, s.local_yaw}};
}

TwoTrajectories::State<double> TwoTrajectories::standing_at(const PredictedState& predicted) noexcept {
  const maps::Pose &pose = predicted.pose, &local = predicted.local;
  return {pose.x, pose.y, pose.yaw, 0, 0, 0, local.x, local.y, local.yaw, 0};
}

VehicleOptions vehicle_options() {
  VehicleOptions options;
  options.model = vehicle_model(Model::name);
  options.front_length = 0.189;
  options.rear_length = 0.135;
  options.limit_acceleration = false;
  options.hold_first_input = true;
  options.cost.outside_terminal_cost = 10;
  options.body.model = BodyModel::box;
  options.own_of<ModelOptions>() = ModelOptions::published();
  return options;
}

vehicle::PlannerOptions planner_options() {
  return {.steer_limit = 0.45,
          .stop_when_blocked = false,
          .verify_plan = false,
          .back_up = false,
          .published = {.maps = true, .wrap_steer = true}};
}

}  // namespace slalom::vehicle::published
