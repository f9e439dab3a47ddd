#pragma once

#include "slalom/vehicle/model/obstacle_cost.hpp"
#include "slalom/vehicle/model/tracking_cost.hpp"
#include "slalom/vehicle/model/vehicle_problem.hpp"

namespace slalom::vehicle {

/// A motion model for PathTracking:
///
///     struct Model {
///       static constexpr const char* name = "kinematic";            // value of `vehicle.model`
///       static constexpr const char* help = "...";
///       static constexpr int inputs = 1;
///       static constexpr std::array input_names{"steering"};        // steering first; then "acceleration"
///       using Options = NoOptions;                                  // the model's own options
///       template <class T> struct State { T x, y, yaw, speed, steer; };   // at least these: rear axle, map
///                                                                         // frame; m, m, rad, m/s, rad
///       Model(const PathTrackingOptions&, const Options&);
///       State<double> start(const VehicleStart&, double reference_speed);
///       template <class T> State<T> step(const State<T>&, const T& reference_speed, const Input<T, inputs>&,
///                                        int k) const;
///     };
template <class M>
concept MotionModel = std::constructible_from<M, const PathTrackingOptions&, const typename M::Options&> &&
    requires(M& m, const M& c, const typename M::template State<double>& x,
             const Input<double, M::inputs>& u) {
  { M::name } -> std::convertible_to<const char*>;
  requires M::input_names.size() == M::inputs;
  { m.start(VehicleStart{}, 1.0) } -> std::same_as<typename M::template State<double>>;
  { c.step(x, x.speed, u, 0) } -> std::same_as<typename M::template State<double>>;
  x.x, x.y, x.yaw, x.speed, x.steer;
};

/// The vehicle problem: follow a path without collisions, with any motion model. It runs over two maps: the
/// reference field (distance to the path, yaw and speed there) in the map frame, and the map of obstacles of
/// the LiDAR scan in the robot's frame.
///
///     cost of a state = distance_weight d^2 + yaw_weight e^2 + collision_weight c
///
/// with d the distance to the path, e the yaw error, c the value of the cost map (Honda et al., ICRA 2024,
/// section V-A, in the text, without a number). Steering is the only input there, and the speed is the
/// path's. If the acceleration is an input, too, there is also a cost of the speed: `speed_weight` times the
/// square of the speed below the path's or, with `single_track`, times the share of a time step that is lost
/// against the path's speed, and then a cost of the grip.
template <MotionModel Model>
class PathTracking {
 public:
  template <class T>
  using State = typename Model::template State<T>;         ///< state of the motion model
  using Options = typename Model::Options;                 ///< the model's own options
  static constexpr const char* name = Model::name;         ///< name in configurations
  static constexpr const char* help = Model::help;         ///< description, in one line
  static constexpr int inputs = Model::inputs;             ///< inputs of a step
  static constexpr auto input_names = Model::input_names;  ///< names of the inputs
  static constexpr bool plans_speed = inputs > 1;          ///< the acceleration is an input
  static constexpr bool long_steps = requires { requires Model::long_steps; };  ///< see Problem

  /// Options must be valid (see validate_options).
  explicit PathTracking(const PathTrackingOptions& options, const Options& own = {})
      : options_(options),
        model_(options, own),
        cost_(options),
        obstacles_(options.body),
        collision_weight_(options.cost.collision_weight) {
    if constexpr (requires { model_.seeks_lap_time(); }) {
      if (model_.seeks_lap_time()) cost_.set_lap_time();
    }
  }

  /// The options given at construction.
  const PathTrackingOptions& options() const { return options_; }
  double time_step() const { return options_.time_step; }  ///< s
  /// The properties of the model.
  VehicleTraits traits() const {
    VehicleTraits traits = traits_of(options_, plans_speed);
    traits.obstacles.meets_others = true;
    if constexpr (requires { model_.complete(traits); }) model_.complete(traits);
    return traits;
  }
  /// The motion model.
  Model& model() noexcept { return model_; }
  /// The motion model.
  const Model& model() const noexcept { return model_; }

  /// Sets the maps that rollouts look up.
  void set_maps(const VehicleMaps& maps) noexcept {
    cost_.set_reference(maps.reference);
    obstacles_.set_map(maps.obstacles, maps.robot);
    others_ = maps.others;
  }

  /// Sets the conditions of the next rollouts.
  void set_conditions(const DrivingConditions& now) noexcept requires requires(Model& m) {
    m.set_conditions(now);
  }
  {
    model_.set_conditions(now);
    cost_.set_conditions(now);
    obstacles_.set_margin_shares(now.margin_share, now.soft_share);
  }

  /// The state at the start; `reference_speed` (m/s) is the path's there.
  State<double> start(const VehicleStart& start, double reference_speed) noexcept {
    return model_.start(start, reference_speed);
  }

  /// Returns a state as the planner uses it.
  PredictedState predicted(const State<double>& s) const noexcept {
    const maps::Point local = maps::inverse_transform(obstacles_.robot(), {s.x, s.y});
    PredictedState made{
        {s.x, s.y, s.yaw}, s.speed, s.steer, {local.x, local.y, s.yaw - obstacles_.robot().yaw}};
    if constexpr (requires { slip_of(s); }) {
      made.yaw_rate = s.yaw_rate;
      made.slip = slip_of(s);
    }
    return made;
  }

  /// Looks up the maps at a state.
  template <class T>
  Surroundings<T> look_up(const State<T>& s) const {
    const T obstacle = obstacles_.in_map_frame(s.x, s.y, s.yaw);
    return cost_.look_up(s.x, s.y, s.speed, obstacle);
  }

  /// The state after step `k` with inputs `u`: steering, rad, within pi / 2; acceleration, m/s^2.
  template <class T>
  State<T> step(const State<T>& s, const Surroundings<T>& seen, const Input<T, inputs>& u, int k) const {
    return model_.step(s, seen.speed, u, k);
  }

  /// Cost of step `k`.
  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Surroundings<T>& seen, const Input<T, inputs>&,
                     int k = 0) const {
    return with_others(with_speed(cost_.stage(s.yaw, seen), s, seen), s, k);
  }
  /// Cost of the last state.
  template <class T>
  Cost<T> terminal_cost(const State<T>& s, const Surroundings<T>& seen) const {
    Cost<T> cost = with_speed(cost_.terminal(s.yaw, seen), s, seen);
    if constexpr (requires { model_.stopping_distance(s); }) {
      cost.value = cost.value + model_.collision_ahead_cost() * speed_of_collision(s);
      if (model_.seeks_lap_time())
        cost.value = cost.value + (cost_.time_cost(model_.steps_behind(s, seen.speed)) +
                                   model_.overspeed_cost(s, seen.speed));
      if (!others_.empty()) cost.value = cost.value + cost_.time_cost(others_.following_cost(s.x, s.y));
    }
    return with_others(cost, s, others_.last_step());
  }
  /// The part of a cost that is due to collisions.
  double collision_part(const Surroundings<double>& seen, bool last) const {
    return cost_.collision_part(seen, last);
  }
  /// The part of the cost of a state at step `k` that is due to moving obstacles.
  double others_part(const State<double>& s, int k) const { return with_others({0.0, false}, s, k).value; }
  /// The part of a cost that is due to the distance to the path.
  double distance_part(const Surroundings<double>& seen, bool last) const {
    return cost_.distance_part(seen, last);
  }

 private:
  /// Lets the car brake from this state on, along the path at its present distance to it. Returns the share
  /// of the energy that is left when it collides with an obstacle of the map, or 0 if it stops before. This
  /// cost makes plans end in states from which the car can stop in time.
  template <class T>
  SLALOM_INLINE T speed_of_collision(const State<T>& s) const {
    constexpr int pieces = 5;  // parts of the way in which the car stops
    const T piece = model_.stopping_distance(s) * T(1.0 / pieces);
    const T lead = T(obstacles_.foremost());
    T sine, cosine;
    sin_cos(s.yaw, sine, cosine);
    T x = s.x + lead * cosine, y = s.y + lead * sine, share(0);
    T turned = wrap_angle(s.yaw - cost_.path_yaw(s.x, s.y, s.yaw));
    for (int i = 0; i < pieces; ++i) {
      x = x + piece * cosine;
      y = y + piece * sine;
      share = max(share, select(obstacles_.blocked(x, y), T(1 - static_cast<double>(i) / pieces), T(0)));
      turned = T(0.5) * turned;
      sin_cos(cost_.path_yaw(x, y, s.yaw) + turned, sine, cosine);
    }
    return share;
  }

  /// Returns `cost` plus the cost of moving obstacles.
  template <class T>
  SLALOM_INLINE Cost<T> with_others(const Cost<T>& cost, const State<T>& s, int k) const {
    if (others_.empty()) return cost;
    T sine, cosine;
    sin_cos(s.yaw, sine, cosine);
    const Cost<T> met = others_.cost(s.x, s.y, sine, cosine, k);
    return {cost.value + T(collision_weight_) * met.value, mask_t<T>(cost.collided | met.collided)};
  }

  template <class T>
  SLALOM_INLINE Cost<T> with_speed(const Cost<T>& cost, const State<T>& s,
                                   const Surroundings<T>& seen) const {
    if constexpr (requires { model_.grip_cost(s); }) {
      const Cost<T> timed = cost_.with_time_lost(cost, s.yaw, s.speed, seen);
      return {timed.value + model_.grip_cost(s), timed.collided};
    } else if constexpr (plans_speed) {
      return cost_.with_speed(cost, s.speed, seen);
    } else {
      return cost;
    }
  }

  PathTrackingOptions options_;  ///< options of the car
  Model model_;
  TrackingCost cost_;       ///< cost of path and speed errors
  ObstacleCost obstacles_;  ///< cost of obstacles
  maps::MovingObstaclesView others_;
  Coefficient collision_weight_;
};

}  // namespace slalom::vehicle
