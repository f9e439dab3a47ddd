#pragma once

#include "slalom/core/grid_view.hpp"
#include "slalom/core/options.hpp"
#include "slalom/core/problem.hpp"

/// The vehicle problem: follow a path and do not touch anything. A kinematic bicycle, steered with a
/// first-order lag, runs over two maps: the reference field (distance to the path, yaw and speed there) in
/// the map frame, and the local cost map of the LiDAR scan in the robot's frame.
///
///     cost of a state = distance_weight d^2 + yaw_weight e^2 + collision_weight c
///
/// with d the distance to the path, e the yaw error, c the value of the cost map (Honda et al., ICRA 2024,
/// section V-A). Steering is the only input there, and the speed is the path's. Where the acceleration is an
/// input too, `speed_weight` times the square of the speed lost to the path's is added.
namespace slalom::vehicle {

/// Where the reference point of the bicycle lies, and so what its yaw gain is.
enum class BicycleForm {
  rear_axle,  ///< x' = v cos(yaw), yaw' = v tan(steer) / (lf + lr): the base_link of a car is its rear axle
  published,  ///< tan(b) = lf/(lf + lr) tan(steer), x' = v cos(yaw + b), yaw' = v sin(b) / lr. The textbook's
              ///< centre of gravity has lr in the first formula; with this one the yaw gain is off by a
              ///< factor (published program)
};
inline const char* const* enum_names(BicycleForm) {
  static constexpr const char* const names[] = {"rear_axle", "published", nullptr};
  return names;
}

/// What the model takes the speed of the next step to be.
enum class SpeedForm {
  reference,  ///< the reference field's speed at the position
  constant,   ///< the present speed
  linear,     ///< towards the reference speed at the start, with constant acceleration
  input,      ///< the second input is the acceleration; the reference field's speed is the limit
};
inline const char* const* enum_names(SpeedForm) {
  static constexpr const char* const names[] = {"reference", "constant", "linear", "input", nullptr};
  return names;
}

/// How the car's body is held against the obstacles.
enum class BodyForm {
  discs,  ///< discs along the body, turned with it, on a map of distances; nearness costs before contact does
  box,    ///< obstacles are inflated by the body as it stands now, whatever way it turns (published program)
};
inline const char* const* enum_names(BodyForm) {
  static constexpr const char* const names[] = {"discs", "box", nullptr};
  return names;
}

/// Options of the vehicle problem. The defaults are the correct forms; what `published` says of an option is
/// the reason why it exists.
struct PathTrackingOptions {
  double time_step = 0.05;           ///< s, of the prediction
  double front_length = 0.15875;     ///< m, lf: centre of gravity to front axle
  double rear_length = 0.17145;      ///< m, lr: centre of gravity to rear axle
  double steer_time_constant = 0.1;  ///< s, first-order lag of the steering
  double dead_time = 0.025;          ///< s, from a command to its first effect on the steering
  BicycleForm bicycle = BicycleForm::rear_axle;
  SpeedForm speed = SpeedForm::reference;
  double distance_weight = 1;
  double yaw_weight = 0.01;
  double terminal_distance_weight = 1;
  double terminal_yaw_weight = 0.01;
  double speed_weight = 1;             ///< s^2/m^2, where the acceleration is an input
  double collision_weight = 1;         ///< times the cost map's values, 100 where occupied
  double max_acceleration = 5;         ///< m/s^2, for `limit_acceleration` and the linear form
  double max_deceleration = 3;         ///< m/s^2, likewise
  double reference_speed = 1.5;        ///< m/s, where no speed profile is used
  double outside_cost = 100;           ///< cost map value off the local map, stage states
  double outside_terminal_cost = 100;  ///< the same at the terminal state; published: 10

  BodyForm body = BodyForm::discs;  ///< published: box
  double body_front = 0.461;        ///< m, reach of the body ahead of the reference point
  double body_rear = 0.119;         ///< m, behind it
  double body_width = 0.31;         ///< m
  double body_margin = 0.04;        ///< m of clearance below which a state collides
  double soft_margin = 0.1;         ///< m of clearance beyond that in which nearness costs
  double soft_cost = 10;  ///< cost map value of that nearness; with discs where it begins to collide,
                          ///< falling off as a square

  bool limit_acceleration = true;  ///< published: false, the speed jumps to the reference field's
  bool exact_lag =
      true;  ///< published: false, explicit Euler, of which the factor is time_step / time constant
  /// Published: true. The dead time is ceil(dead_time / time_step) steps in which the sequence's own first
  /// input acts (the commands under way are not remembered). Otherwise the state is led ahead by the dead
  /// time with the commands sent, and the rollout knows no dead time.
  bool hold_first_input = false;
  /// Published: true. Collisions are looked up along a second rollout in the robot's frame that starts with
  /// the wheels straight, whatever their angle.
  bool straight_local_rollout = false;
  /// Published: true. In the linear form a car that is too fast speeds up (a sign error of the published
  /// program).
  bool linear_sign_error = false;
  bool localisation_less = false;  ///< drive by the cost map alone, without pose or path
};

template <class Options, class Visit>
requires is_options_of<Options, PathTrackingOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.time_step, Declaration{.name = "time_step",
                                 .symbol = "Delta tau",
                                 .unit = "s",
                                 .help = "step of the prediction",
                                 .min = 1e-3,
                                 .max = 1});
  visit(o.front_length, Declaration{.name = "front_length",
                                    .symbol = "lf",
                                    .unit = "m",
                                    .help = "centre of gravity to front axle",
                                    .min = 1e-3,
                                    .max = 10});
  visit(o.rear_length, Declaration{.name = "rear_length",
                                   .symbol = "lr",
                                   .unit = "m",
                                   .help = "centre of gravity to rear axle",
                                   .min = 1e-3,
                                   .max = 10});
  visit(o.steer_time_constant, Declaration{.name = "steer_time_constant",
                                           .symbol = "tau",
                                           .unit = "s",
                                           .help = "first-order lag of the steering",
                                           .min = 1e-3,
                                           .max = 10});
  visit(o.dead_time, Declaration{.name = "dead_time",
                                 .unit = "s",
                                 .help = "from a command to its first effect on the steering",
                                 .min = 0,
                                 .max = 1});
  visit(o.bicycle,
        Declaration{.name = "bicycle", .help = "reference point and yaw gain of the bicycle model"});
  visit(o.speed, Declaration{.name = "speed", .help = "what the model takes the next speed to be"});
  visit(o.distance_weight, Declaration{.name = "distance_weight",
                                       .help = "weight of the squared distance to the path, 1/m^2",
                                       .min = 0});
  visit(o.yaw_weight,
        Declaration{.name = "yaw_weight", .help = "weight of the squared yaw error, 1/rad^2", .min = 0});
  visit(o.terminal_distance_weight,
        Declaration{.name = "terminal_distance_weight", .help = "the same at the last state", .min = 0});
  visit(o.terminal_yaw_weight,
        Declaration{.name = "terminal_yaw_weight", .help = "the same at the last state", .min = 0});
  visit(o.speed_weight,
        Declaration{.name = "speed_weight",
                    .help = "weight of the squared speed lost to the path's, s^2/m^2, where the acceleration "
                            "is an input",
                    .min = 0});
  visit(o.collision_weight,
        Declaration{
            .name = "collision_weight", .help = "times the cost map's value, 100 where occupied", .min = 0});
  visit(o.max_acceleration, Declaration{.name = "max_acceleration",
                                        .unit = "m/s^2",
                                        .help = "of the speed prediction",
                                        .min = 0,
                                        .max = 100});
  visit(o.max_deceleration, Declaration{.name = "max_deceleration",
                                        .unit = "m/s^2",
                                        .help = "of the speed prediction",
                                        .min = 0,
                                        .max = 100});
  visit(o.reference_speed, Declaration{.name = "reference_speed",
                                       .unit = "m/s",
                                       .help = "where no speed profile is used",
                                       .min = 0,
                                       .max = 100});
  visit(o.outside_cost,
        Declaration{.name = "outside_cost", .help = "cost map value off the local map", .min = 0});
  visit(o.outside_terminal_cost,
        Declaration{.name = "outside_terminal_cost", .help = "the same at the last state", .min = 0});
  visit(o.body, Declaration{.name = "body", .help = "how the body is held against obstacles"});
  visit(o.body_front, Declaration{.name = "body_front",
                                  .unit = "m",
                                  .help = "reach of the body ahead of the reference point",
                                  .min = 0,
                                  .max = 10});
  visit(o.body_rear,
        Declaration{
            .name = "body_rear", .unit = "m", .help = "reach of the body behind it", .min = 0, .max = 10});
  visit(o.body_width,
        Declaration{.name = "body_width", .unit = "m", .help = "width of the body", .min = 0.01, .max = 10});
  visit(o.body_margin, Declaration{.name = "body_margin",
                                   .unit = "m",
                                   .help = "clearance below which a state collides",
                                   .min = 0,
                                   .max = 1});
  visit(o.soft_margin, Declaration{.name = "soft_margin",
                                   .unit = "m",
                                   .help = "clearance beyond that in which nearness costs",
                                   .min = 0,
                                   .max = 1});
  visit(o.soft_cost, Declaration{.name = "soft_cost",
                                 .help = "cost map value of nearness just short of collision",
                                 .min = 0,
                                 .max = 100});
  visit(o.limit_acceleration, Declaration{.name = "limit_acceleration",
                                          .help = "the predicted speed respects the acceleration limits"});
  visit(o.exact_lag,
        Declaration{.name = "exact_lag",
                    .help = "exact discretisation of the steering lag instead of explicit Euler"});
  visit(o.hold_first_input, Declaration{.name = "hold_first_input",
                                        .help = "dead time as steps in which the first input is held"});
  visit(o.straight_local_rollout,
        Declaration{.name = "straight_local_rollout",
                    .help = "collisions along a second rollout that starts with straight wheels"});
  visit(o.linear_sign_error, Declaration{.name = "linear_sign_error",
                                         .help = "a car that is too fast speeds up in the linear form"});
  visit(o.localisation_less, Declaration{.name = "localisation_less",
                                         .help = "drive by the cost map alone, without pose or path"});
}

/// What a state meets in the maps.
template <class T>
struct Surroundings {
  T distance;  ///< m to the path
  T yaw;       ///< rad, of the path; off the reference map the yaw error to assume
  T speed;     ///< m/s, reference
  T outside;   ///< 1 off the reference map, else 0
  T obstacle;  ///< cost map value, 100 in collision; negative off the map
};

/// The state of the car; with `separate_local` also that of a second trajectory in the robot's frame.
template <class T, bool separate_local>
struct CarState {
  T x, y, yaw;  ///< m, m, rad, map frame
  T speed;      ///< m/s
  T steer;      ///< rad
  T held;       ///< rad, the first input while it is held
};
template <class T>
struct CarState<T, true> {
  T x, y, yaw, speed, steer, held;
  T local_x, local_y, local_yaw, local_steer;  ///< m, m, rad, rad
};

/// How many inputs the problem with these options has: 1, or 2 where the acceleration is one.
constexpr int input_count(const PathTrackingOptions& options) noexcept {
  return options.speed == SpeedForm::input ? 2 : 1;
}

/// The problem for the solvers. `separate_local` is `straight_local_rollout` at compile time, `input_count`
/// that of the options. Inputs: steering, rad, of a magnitude below pi/2, as that of the start's steering;
/// and acceleration, m/s^2, of which no more than `max_deceleration` and `max_acceleration` takes effect.
template <bool separate_local, int input_count = 1>
class PathTracking {
 public:
  template <class T>
  using State = CarState<T, separate_local>;
  static constexpr int inputs = input_count;

  /// `options` must be valid, and have as many inputs.
  explicit PathTracking(const PathTrackingOptions& options);

  const PathTrackingOptions& options() const { return options_; }
  double time_step() const { return options_.time_step; }  ///< s

  /// Sets the maps. With a box, `obstacles` is the cost map: 0 (free) or 100; with discs it is the map of
  /// distances, m, up to `clearance_reach()`; its ring is negative. `robot_x, robot_y, robot_yaw` is the pose
  /// of its frame in the map frame. The reference field's cells are {distance, yaw, speed, -}.
  void set_maps(const GridView<4>& reference, const GridView<1>& obstacles, double robot_x, double robot_y,
                double robot_yaw);
  /// The distance up to which the map of distances must be right, m.
  static double clearance_reach(const PathTrackingOptions& options);

  /// The reference speed at the start, for the linear form; m/s.
  void set_target_speed(double speed) { target_speed_ = static_cast<float>(speed); }

  template <class T>
  Surroundings<T> look_up(const State<T>& s) const {
    const T obstacle = look_up_obstacle(s);
    if (options_.localisation_less) return {T(0), T(0), s.speed, T(0), obstacle};
    const CellValues<T> reference = slalom::look_up(reference_, s.x, s.y);
    return {reference.a, reference.b, reference.c, reference.d, obstacle};
  }

  template <class T>
  State<T> step(const State<T>& s, const Surroundings<T>& seen, const Input<T, inputs>& u, int k) const {
    State<T> next;
    const bool first = options_.hold_first_input && k == 0;
    const T command = options_.hold_first_input && !first && k <= held_steps_ ? s.held : u[0];
    next.held = first ? u[0] : s.held;
    if constexpr (inputs == 2) {
      next.speed = next_speed(s.speed, seen.speed, u[1]);
    } else {
      next.speed = next_speed(s.speed, seen.speed);
    }
    const T travelled = s.speed * T(time_step_);
    move(s.x, s.y, s.yaw, s.steer, command, travelled, next.x, next.y, next.yaw, next.steer);
    if constexpr (separate_local) {
      move(s.local_x, s.local_y, s.local_yaw, s.local_steer, command, travelled, next.local_x, next.local_y,
           next.local_yaw, next.local_steer);
    }
    return next;
  }

  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Surroundings<T>& seen, const Input<T, inputs>&) const {
    return cost(s, seen, distance_weight_, yaw_weight_, outside_cost_);
  }
  template <class T>
  Cost<T> terminal_cost(const State<T>& s, const Surroundings<T>& seen) const {
    return cost(s, seen, terminal_distance_weight_, terminal_yaw_weight_, outside_terminal_cost_);
  }
  /// The collision part of a cost alone.
  template <class T>
  T collision_cost(const Surroundings<T>& seen, const Coefficient& outside) const {
    return T(collision_weight_) * select(seen.obstacle < T(0), T(outside), seen.obstacle);
  }

 private:
  template <class T>
  SLALOM_INLINE T look_up_obstacle(const State<T>& s) const {
    if (options_.body == BodyForm::discs) return disc_obstacle(s);
    if constexpr (separate_local) {
      return slalom::look_up(obstacles_, s.local_x, s.local_y);
    } else if constexpr (is_pack<T>) {
      // From the map frame to cells at once.
      return look_up_cell(obstacles_, T(to_cells_[0]) * s.x + (T(to_cells_[1]) * s.y + T(to_cells_[2])),
                          T(to_cells_[3]) * s.x + (T(to_cells_[4]) * s.y + T(to_cells_[5])));
    } else {
      return slalom::look_up(obstacles_, T(to_local_[0]) * s.x + (T(to_local_[1]) * s.y + T(to_local_[2])),
                             T(to_local_[3]) * s.x + (T(to_local_[4]) * s.y + T(to_local_[5])));
    }
  }

  /// The cost map value of a body of discs: by the least clearance of their middles.
  template <class T>
  SLALOM_INLINE T disc_obstacle(const State<T>& s) const {
    T sine, cosine, clearance;
    if constexpr (separate_local) {
      sin_cos(s.local_yaw, sine, cosine);
      clearance = least_clearance(s.local_x, s.local_y, cosine, sine);
    } else {
      sin_cos(s.yaw, sine, cosine);
      clearance = least_clearance(T(to_local_[0]) * s.x + (T(to_local_[1]) * s.y + T(to_local_[2])),
                                  T(to_local_[3]) * s.x + (T(to_local_[4]) * s.y + T(to_local_[5])),
                                  T(to_local_[0]) * cosine + T(to_local_[1]) * sine,
                                  T(to_local_[3]) * cosine + T(to_local_[4]) * sine);
    }
    const T nearness = max((T(soft_end_) - clearance) * T(inverse_soft_margin_), T(0));
    const T value = select(clearance < T(contact_clearance_), T(100), T(soft_cost_) * nearness * nearness);
    return select(clearance < T(0), T(-1), value);
  }
  template <class T>
  SLALOM_INLINE T least_clearance(const T& x, const T& y, const T& heading_x, const T& heading_y) const {
    T least = slalom::look_up(obstacles_, x + T(disc_[0]) * heading_x, y + T(disc_[0]) * heading_y);
    least = min(least, slalom::look_up(obstacles_, x + T(disc_[1]) * heading_x, y + T(disc_[1]) * heading_y));
    return min(least, slalom::look_up(obstacles_, x + T(disc_[2]) * heading_x, y + T(disc_[2]) * heading_y));
  }

  template <class T>
  SLALOM_INLINE void move(const T& x, const T& y, const T& yaw, const T& steer, const T& command,
                          const T& travelled, T& next_x, T& next_y, T& next_yaw, T& next_steer) const {
    T sin_steer, cos_steer, sin_yaw, cos_yaw;
    // Without localisation the published program computes the slip angle from the command instead of the
    // wheels' angle.
    const bool use_command = options_.localisation_less && options_.bicycle == BicycleForm::published;
    sin_cos_half_turn(use_command ? command : steer, sin_steer, cos_steer);
    sin_cos(yaw, sin_yaw, cos_yaw);
    if (options_.bicycle == BicycleForm::published) {
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
    next_steer = steer + (command - steer) * T(lag_factor_);
  }

  template <class T>
  SLALOM_INLINE T next_speed(const T& speed, const T& reference) const {
    if (options_.speed == SpeedForm::constant) return speed;
    if (options_.speed == SpeedForm::linear) {
      const T target = T(target_speed_), faster = min(speed + T(speed_gain_), target);
      const T slower = max(speed - T(linear_loss_), target);
      return select(speed <= target, faster, slower);
    }
    if (!options_.limit_acceleration) return reference;
    return min(max(reference, speed - T(speed_loss_)), speed + T(speed_gain_));
  }
  /// With the acceleration asked for, as far as the car is capable of it; never backwards, and no faster than
  /// the reference as soon as brakes allow.
  template <class T>
  SLALOM_INLINE T next_speed(const T& speed, const T& reference, const T& acceleration) const {
    const T slowest = speed - T(speed_loss_), fastest = min(speed + T(speed_gain_), max(reference, slowest));
    return max(min(max(speed + acceleration * T(time_step_), slowest), fastest), T(0));
  }

  template <class T>
  SLALOM_INLINE Cost<T> cost(const State<T>& s, const Surroundings<T>& seen,
                             const Coefficient& distance_weight, const Coefficient& yaw_weight,
                             const Coefficient& outside) const {
    const T collision = collision_cost(seen, outside);
    T value = collision;
    if (!options_.localisation_less) {
      const T yaw_error = select(seen.outside > T(0), seen.yaw, wrap_angle(s.yaw - seen.yaw));
      value = value + (T(distance_weight) * square(seen.distance) + T(yaw_weight) * square(yaw_error));
    }
    if constexpr (inputs == 2) value = value + T(speed_weight_) * square(max(seen.speed - s.speed, T(0)));
    return {value, mask_t<T>((seen.obstacle < T(0)) | (seen.obstacle >= T(100)))};
  }

  PathTrackingOptions options_;
  GridView<4> reference_;
  GridView<1> obstacles_;
  double to_local_[6] = {1, 0, 0, 0, 1, 0};  ///< m in the map frame -> m in the robot's
  Coefficient disc_[3];                      ///< m, middles of the body's discs ahead of the reference point
  Coefficient contact_clearance_;            ///< m from a disc's middle
  Coefficient soft_end_;                     ///< m from a disc's middle
  Coefficient inverse_soft_margin_;
  Coefficient soft_cost_;
  Coefficient to_cells_[6] = {1, 0, 0, 0, 1, 0};  ///< m in the map frame -> cells of the cost map
  int held_steps_ = 0;
  Coefficient time_step_;
  Coefficient distance_weight_, yaw_weight_, outside_cost_;
  Coefficient terminal_distance_weight_, terminal_yaw_weight_, outside_terminal_cost_;
  Coefficient speed_weight_;
  Coefficient collision_weight_;
  Coefficient slip_ratio_;
  Coefficient inverse_length_;
  Coefficient lag_factor_;
  Coefficient speed_gain_;
  Coefficient speed_loss_;
  Coefficient linear_loss_;  ///< speed lost in a step of the linear form
  Coefficient target_speed_;
};

extern template class PathTracking<false>;
extern template class PathTracking<true>;
extern template class PathTracking<false, 2>;

}  // namespace slalom::vehicle
