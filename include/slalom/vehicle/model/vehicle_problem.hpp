#pragma once

#include "slalom/core/grid_view.hpp"
#include "slalom/core/problem.hpp"
#include "slalom/maps/command.hpp"
#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"

/// The functions through which a planner uses any vehicle problem.
namespace slalom::vehicle {

/// The start of a rollout, from odometry and observers.
struct VehicleStart {
  maps::Pose pose;      ///< pose of the rear axle, map frame
  double speed = 0;     ///< m/s
  double steer = 0;     ///< rad, of the wheels
  double yaw_rate = 0;  ///< rad/s
  double slip = 0;      ///< rad, from the body's axis to the direction of travel of the centre of gravity
};

/// The cost of a predicted sequence, by term.
struct PredictedCost {
  double state = 0;       ///< cost of distance, yaw and speed, without collisions
  double distance = 0;    ///< the part of `state` for the distance to the path
  double collision = 0;   ///< cost of collisions and nearness to obstacles
  bool collided = false;  ///< a state after the first free one collides, or none is free
};

/// A predicted state.
struct PredictedState {
  maps::Pose pose;       ///< pose of the rear axle, map frame
  double speed = 0;      ///< m/s
  double steer = 0;      ///< rad, of the wheels
  maps::Pose local;      ///< pose of the body in the frame of the robot at the time of the scan
  double yaw_rate = 0;   ///< rad/s; 0 if the model has none
  double slip = 0;       ///< rad; 0 if the model has none
  PredictedCost cost{};  ///< sum over the states up to this one
};

/// The maps that rollouts look up; they must outlive their use.
struct VehicleMaps {
  GridView<4> reference;  ///< {distance to the path in m, yaw in rad, speed in m/s, 1 off the map}, map frame
  GridView<1> obstacles;  ///< map of obstacles as ObstacleTraits::map says, robot's frame; its ring
                          ///< is negative
  maps::Pose robot;       ///< the robot's frame, in the map frame
  maps::MovingObstaclesView others{};  ///< obstacles that move, map frame

  /// Returns the same maps in a frame that is parallel to the map frame and begins at `origin` (m). Rollouts
  /// in float32 need it: at 1e6 m from the origin of their frame a float32 resolves 0.06 m.
  VehicleMaps relative_to(const maps::Point& origin) const noexcept {
    return {reference.relative_to(origin.x, origin.y),
            obstacles,
            {robot.x - origin.x, robot.y - origin.y, robot.yaw},
            others.relative_to(origin)};
  }
};

/// The content of the map of obstacles.
enum class ObstacleMap {
  inflated,  ///< cost map: 100 where the body, with its present heading, would collide
  clearance  ///< distance to the nearest obstacle, m, up to `clearance_reach`
};

/// The price of lost time. A car that stands usually pays less than one that passes close to an obstacle or
/// far from the path. That is right for a moment, but the car must not stand forever.
enum class Urgency {
  usual,    ///< the weights of the options
  passing,  ///< lost time costs 4 times as much, the distance to the path a tenth
  detour    ///< the path leads around an obstacle: lost time costs 10 times as much
};

/// The ground, and how a car whose tyres slip should drive on it. The defaults are for a free road.
struct DrivingConditions {
  double friction = 1;               ///< coefficient between tyres and ground, > 0
  double top_speed = 1e3;            ///< m/s, the highest speed of predictions
  double reverse = 0;                ///< m/s; above 0, the car reverses along the path, at most at this speed
  Urgency urgency = Urgency::usual;  ///< price of lost time
  double margin_share = 1;           ///< 0 to 1, share of the body's margin that predictions keep
  double soft_share = 1;             ///< above 0 to 1, share of the soft margin in which nearness has a cost
};

/// Demands of a vehicle model on the maps of obstacles.
struct ObstacleTraits {
  ObstacleMap map = ObstacleMap::inflated;  ///< content of the map of obstacles
  double reach = 0;                         ///< m, of the distances in a map of clearance
  bool meets_others = false;                ///< rollouts meet obstacles that move
};

/// Origin of the speed that a car without tyre slip is commanded.
struct SpeedTraits {
  bool planned = false;                 ///< from the plan, not from the path
  bool unlimited_acceleration = false;  ///< the predicted speed may be at once that of the reference field
  bool follows_path = true;             ///< false: drives by the obstacles alone, at `reference`
  double reference = 0;                 ///< m/s, without a path
};

/// Grip, steering and motor of a car whose tyres slip.
struct TyreTraits {
  double friction = 0;               ///< friction that the options give, > 0 if tyres slip, else 0
  double usable_grip = 0;            ///< the share of the friction that plans may use
  double braking_share = 1;          ///< the share of the usable grip that the mean deceleration may use
  bool seeks_lap_time = false;       ///< plans seek the shortest time, whatever the path's speeds
  double half_steer_speed = 0;       ///< m/s; an input steers half as much as at standstill
  double stopping_deceleration = 0;  ///< m/s^2; a plan must be able to stop with it
  double switch_speed = 0;           ///< m/s; above it the motor's power is the limit
};

/// Properties of a vehicle model.
struct VehicleTraits {
  double time_step = 0;         ///< s, of the prediction, > 0
  double dead_time = 0;         ///< s, of the steering, which the planner compensates; 0 if the model does
  double wheelbase = 0;         ///< m, > 0
  double rear_length = 0;       ///< m, centre of gravity to rear axle
  double max_acceleration = 0;  ///< m/s^2, of the predicted speed
  double max_deceleration = 0;  ///< m/s^2, of a braking car
  BodyOptions body{};           ///< the body that must not collide
  ObstacleTraits obstacles{};   ///< for the maps of obstacles
  SpeedTraits speed{};          ///< for a planner without tyre slip
  TyreTraits tyres{};           ///< for a planner with tyre slip
};

/// Returns the traits of a model that uses these options unchanged.
VehicleTraits traits_of(const PathTrackingOptions& options, bool plans_speed);

/// A Problem whose input 0 is the steering angle, rad; input 1 may be the acceleration, m/s^2. Its costs are
/// `Cost<T>` with the collision. In addition it has
///  - `set_maps(const VehicleMaps&)`: the maps for the next rollouts;
///  - `start(const VehicleStart&, double reference_speed)`: the state in which they start, where the path has
///    this speed (m/s);
///  - `predicted(state)`: the pose, speed and steering angle of a state;
///  - `collision_part(seen, last)`, `distance_part(seen, last)`: the parts of a state's cost for collisions
///    and for the distance to the path; `seen` was returned by `look_up`, `last` tells whether the state is
///    the last one of a sequence;
///  - `traits()`.
/// The problem chooses the layout of its state. `ProblemModel` gives it maps and start relative to the
/// position of the start; in a problem, "map frame" means this frame.
template <class P>
concept VehicleProblem = Problem<P> && requires(P& p, const P& c, const slalom::detail::StateOf<P, double>& x,
                                                const VehicleMaps& maps, const VehicleStart& start) {
  p.set_maps(maps);
  { p.start(start, 1.0) } -> std::same_as<slalom::detail::StateOf<P, double>>;
  { c.predicted(x) } -> std::same_as<PredictedState>;
  { c.collision_part(slalom::detail::look_up<P, double>(c, x), true) } -> std::convertible_to<double>;
  { c.distance_part(slalom::detail::look_up<P, double>(c, x), true) } -> std::convertible_to<double>;
  { c.traits() } -> std::same_as<VehicleTraits>;
};

/// A vehicle problem of a car whose tyres slip. `set_conditions` sets the conditions of the next rollouts,
/// and `model()` returns a motion model like SingleTrack.
template <class P>
concept DynamicVehicleProblem = VehicleProblem<P> &&
    requires(P& p, const P& c, const VehicleStart& start, const slalom::detail::StateOf<P, double>& x) {
  p.set_conditions(DrivingConditions{});
  { c.model().advance(start, Command{}, 0.1, 1.0) } -> std::same_as<VehicleStart>;
  { c.model().limited(x, 1.0, 1.0) } -> std::convertible_to<double>;
};

}  // namespace slalom::vehicle
