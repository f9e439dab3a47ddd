#include "slalom/vehicle/model/path_tracking.hpp"

#include <cmath>

namespace slalom::vehicle {

namespace {

/// Of three equal discs that cover the body's rectangle, m.
double disc_radius(const PathTrackingOptions& options) {
  return std::hypot((options.body_front + options.body_rear) / 6, options.body_width / 2);
}

}  // namespace

template <bool separate_local, int input_count>
PathTracking<separate_local, input_count>::PathTracking(const PathTrackingOptions& options)
    : options_(options),
      held_steps_(
          options.hold_first_input ? static_cast<int>(std::ceil(options.dead_time / options.time_step)) : 0),
      time_step_(options.time_step),
      distance_weight_(options.distance_weight),
      yaw_weight_(options.yaw_weight),
      outside_cost_(options.outside_cost),
      terminal_distance_weight_(options.terminal_distance_weight),
      terminal_yaw_weight_(options.terminal_yaw_weight),
      outside_terminal_cost_(options.outside_terminal_cost),
      speed_weight_(options.speed_weight),
      collision_weight_(options.collision_weight),
      slip_ratio_(options.front_length / (options.front_length + options.rear_length)),
      inverse_length_(options.bicycle == BicycleForm::published
                          ? 1 / options.rear_length
                          : 1 / (options.front_length + options.rear_length)),
      lag_factor_(options.exact_lag ? 1 - std::exp(-options.time_step / options.steer_time_constant)
                                    : options.time_step / options.steer_time_constant),
      speed_gain_(options.max_acceleration * options.time_step),
      speed_loss_(options.max_deceleration * options.time_step),
      linear_loss_((options.linear_sign_error ? -1 : 1) * options.max_deceleration * options.time_step),
      target_speed_(options.reference_speed) {
  const double length = options.body_front + options.body_rear;
  for (int i = 0; i < 3; ++i) disc_[i] = -options.body_rear + length * (2 * i + 1) / 6;
  contact_clearance_ = disc_radius(options) + options.body_margin;
  soft_end_ = disc_radius(options) + options.body_margin + options.soft_margin;
  inverse_soft_margin_ = options.soft_margin > 0 ? 1 / options.soft_margin : 0;
  soft_cost_ = options.soft_margin > 0 ? options.soft_cost : 0;
}

template <bool separate_local, int input_count>
double PathTracking<separate_local, input_count>::clearance_reach(const PathTrackingOptions& options) {
  return disc_radius(options) + options.body_margin + options.soft_margin + 0.01;
}

template <bool separate_local, int input_count>
void PathTracking<separate_local, input_count>::set_maps(const GridView<4>& reference,
                                                         const GridView<1>& obstacles, double robot_x,
                                                         double robot_y, double robot_yaw) {
  reference_ = reference;
  obstacles_ = obstacles;
  const double c = std::cos(robot_yaw), s = std::sin(robot_yaw);
  to_local_[0] = c;
  to_local_[1] = s;
  to_local_[2] = -c * robot_x - s * robot_y;
  to_local_[3] = -s;
  to_local_[4] = c;
  to_local_[5] = s * robot_x - c * robot_y;
  for (int i = 0; i < 6; ++i) {
    const GridAxis& axis = i < 3 ? obstacles.rows_axis() : obstacles.columns_axis();
    to_cells_[i] = to_local_[i] * axis.scale + (i % 3 == 2 ? axis.offset : 0);
  }
}

template class PathTracking<false>;
template class PathTracking<true>;
template class PathTracking<false, 2>;

}  // namespace slalom::vehicle
