#pragma once

#include "slalom/vehicle/model/actuation.hpp"
#include "slalom/vehicle/model/obstacle_cost.hpp"
#include "slalom/vehicle/model/tracking_cost.hpp"
#include "slalom/vehicle/model/vehicle_problem.hpp"
#include "slalom/vehicle/published/model_options.hpp"

namespace slalom::vehicle::published {

/// The bicycle of the published program: one step of its pose and steering.
class Bicycle {
 public:
  /// Takes the options of the car and of the model.
  Bicycle(const PathTrackingOptions& options, const ModelOptions& own);

  /// The pose and wheels' angle after `travelled` (m) with this command (rad).
  template <class T>
  SLALOM_INLINE void move(const T& x, const T& y, const T& yaw, const T& steer, const T& command,
                          const T& travelled, T& next_x, T& next_y, T& next_yaw, T& next_steer) const {
    T sin_steer, cos_steer, sin_yaw, cos_yaw;
    sin_cos_half_turn(slip_from_command_ ? command : steer, sin_steer, cos_steer);
    sin_cos(yaw, sin_yaw, cos_yaw);
    if constexpr (!is_pack<T>) {
      // A published sv_mpc may send any angle; tan and atan see it less half turns.
      if (cos_steer < 0) sin_steer = -sin_steer, cos_steer = -cos_steer;
    }
    if (model_ == BicycleModel::published) {
      // sin and cos of b = atan(ratio tan(steer)), without the inverse function.
      const T opposite = T(slip_ratio_) * sin_steer;
      const T scale = travelled * reciprocal_sqrt(cos_steer * cos_steer + opposite * opposite);
      const T along = scale * cos_steer, across = scale * opposite;
      next_x = x + (along * cos_yaw - across * sin_yaw);
      next_y = y + (along * sin_yaw + across * cos_yaw);
      next_yaw = yaw + across * T(inverse_length_);
    } else {
      next_yaw = yaw + travelled * T(inverse_length_) * sin_steer / cos_steer;
      next_x = x + travelled * cos_yaw;
      next_y = y + travelled * sin_yaw;
    }
    next_steer = steering_.turned(steer, command);
  }

  /// Model of the steering.
  const SteeringActuator& steering() const { return steering_; }

 private:
  BicycleModel model_;
  bool slip_from_command_;  ///< without localisation the slip angle comes from the command, not the wheels
  SteeringActuator steering_;
  Coefficient slip_ratio_;
  Coefficient inverse_length_;  ///< 1/m
};

/// The published vehicle problem with one trajectory: collisions are looked up where the car is.
class OneTrajectory {
 public:
  /// State of the dynamics.
  template <class T>
  struct State {
    T x, y, yaw;  ///< m, m, rad, map frame
    T speed;      ///< m/s
    T steer;      ///< rad, of the wheels
    T held;       ///< rad, the sequence's first input where it is held
  };
  static constexpr int inputs = 1;  ///< steering, rad, of a magnitude below pi / 2

  /// Options must be valid (see validate_options).
  OneTrajectory(const PathTrackingOptions& options, const ModelOptions& own);

  /// The options given at construction.
  const PathTrackingOptions& options() const { return options_; }
  double time_step() const { return options_.time_step; }  ///< s
  /// The properties of the model.
  VehicleTraits traits() const { return traits_of(options_, false); }

  /// Sets the maps that rollouts look up.
  void set_maps(const VehicleMaps& maps) noexcept {
    cost_.set_reference(maps.reference);
    obstacles_.set_map(maps.obstacles, maps.robot);
  }
  /// The target of SpeedModel::linear, m/s.
  void set_target_speed(double speed) { speed_.set_target(speed); }

  /// The state at the start; `reference_speed` (m/s) is that of the path.
  State<double> start(const VehicleStart& start, double reference_speed) noexcept;
  /// A state as the planner needs it.
  PredictedState predicted(const State<double>& s) const noexcept;

  /// Looks up the maps at a state.
  template <class T>
  Surroundings<T> look_up(const State<T>& s) const {
    const T obstacle = obstacles_.in_map_frame(s.x, s.y, s.yaw);
    return cost_.look_up(s.x, s.y, s.speed, obstacle);
  }
  /// State after one step.
  template <class T>
  State<T> step(const State<T>& s, const Surroundings<T>& seen, const Input<T, 1>& u, int k) const {
    State<T> next;
    T command, travelled;
    begin_step(s, seen, u, k, next, command, travelled);
    bicycle_.move(s.x, s.y, s.yaw, s.steer, command, travelled, next.x, next.y, next.yaw, next.steer);
    return next;
  }
  /// Cost of a step.
  template <class S, class T>
  Cost<T> stage_cost(const S& s, const Surroundings<T>& seen, const Input<T, 1>&) const {
    return cost_.stage(s.yaw, seen);
  }
  /// Cost of the last state.
  template <class S, class T>
  Cost<T> terminal_cost(const S& s, const Surroundings<T>& seen) const {
    return cost_.terminal(s.yaw, seen);
  }
  /// The part of a cost that collisions make.
  double collision_part(const Surroundings<double>& seen, bool last) const {
    return cost_.collision_part(seen, last);
  }
  /// The part of a cost that the distance to the path makes.
  double distance_part(const Surroundings<double>& seen, bool last) const {
    return cost_.distance_part(seen, last);
  }

 protected:
  /// Sets the speed of the next state; finds the command that acts (rad) and the way on which it does (m).
  template <class S, class T>
  SLALOM_INLINE void begin_step(const S& s, const Surroundings<T>& seen, const Input<T, 1>& u, int k, S& next,
                                T& command, T& travelled) const {
    const SteeringActuator& steering = bicycle_.steering();
    command = steering.acting(s.held, u[0], k);
    next.held = steering.held(s.held, u[0], k);
    next.speed = speed_.following(s.speed, seen.speed);
    travelled = s.speed * T(time_step_);
  }

  PathTrackingOptions options_;  ///< options of the car
  Bicycle bicycle_;              ///< motion of the car
  SpeedPrediction speed_;        ///< prediction of the speed
  TrackingCost cost_;            ///< cost of path and speed errors
  ObstacleCost obstacles_;       ///< cost of obstacles
  Coefficient time_step_;        ///< s, of a step
};

/// The published vehicle problem as published: collisions are looked up along a second trajectory in the
/// robot's frame, which starts at its origin with straight wheels.
class TwoTrajectories : public OneTrajectory {
 public:
  /// State of the dynamics.
  template <class T>
  struct State {
    T x, y, yaw, speed, steer, held;             ///< state of OneTrajectory
    T local_x, local_y, local_yaw, local_steer;  ///< m, m, rad, rad, robot's frame
  };

  using OneTrajectory::OneTrajectory;

  /// The state at the start; `reference_speed` (m/s) is that of the path.
  State<double> start(const VehicleStart& start, double reference_speed) noexcept;
  /// A state as the planner needs it.
  PredictedState predicted(const State<double>& s) const noexcept;
  /// The state of which `predicted` gives the pose and the local pose, standing, with straight wheels.
  static State<double> standing_at(const PredictedState& predicted) noexcept;

  /// Looks up the maps at a state.
  template <class T>
  Surroundings<T> look_up(const State<T>& s) const {
    const T obstacle = obstacles_.in_robot_frame(s.local_x, s.local_y, s.local_yaw);
    return cost_.look_up(s.x, s.y, s.speed, obstacle);
  }
  /// State after one step.
  template <class T>
  State<T> step(const State<T>& s, const Surroundings<T>& seen, const Input<T, 1>& u, int k) const {
    State<T> next;
    T command, travelled;
    begin_step(s, seen, u, k, next, command, travelled);
    bicycle_.move(s.x, s.y, s.yaw, s.steer, command, travelled, next.x, next.y, next.yaw, next.steer);
    bicycle_.move(s.local_x, s.local_y, s.local_yaw, s.local_steer, command, travelled, next.local_x,
                  next.local_y, next.local_yaw, next.local_steer);
    return next;
  }
};

/// The published vehicle problem as a vehicle model: one of the two, as `straight_local_rollout` says.
struct Model {
  static constexpr const char* name = "published";  ///< name in configurations
  /// Description, in one line.
  static constexpr const char* help = "the vehicle problem of the paper's program";
  static constexpr int inputs = OneTrajectory::inputs;  ///< inputs of a step
  static constexpr std::array input_names{"steering"};  ///< names of the inputs
  using Options = ModelOptions;                         ///< the model's own options

  /// Returns the result of `use` for the problem of these options.
  template <class Use>
  static auto with_problem(const PathTrackingOptions& options, const Options& own, Use&& use) {
    return own.straight_local_rollout ? use(TwoTrajectories(options, own)) : use(OneTrajectory(options, own));
  }
};

}  // namespace slalom::vehicle::published
