#include "slalom/sim/dynamics.hpp"

#include <algorithm>

#include "slalom/core/gravity.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::sim {
namespace {

double sign(double value) {
  return value < 0 ? -1.0 : 1.0;
}

/// The rates of a car that moves in a direction (rad), without those of yaw, yaw rate and slip.
CarState rates(const CarState& s, double direction, const DriveInput& u) {
  return {s.speed * std::cos(direction), s.speed * std::sin(direction), u.steer_rate, u.acceleration};
}

CarState kinematic(const CarParameters& car, const CarState& s, const DriveInput& u) {
  const double slope = std::tan(s.steer) / car.wheelbase();
  const double slip = std::atan(car.rear_length * slope);
  CarState d = rates(s, s.yaw + slip, u);
  d.yaw = s.speed * std::cos(slip) * slope;
  return d;
}

CarState gym_kinematic(const CarParameters& car, const CarState& s, const DriveInput& u) {
  const double tangent = std::tan(s.steer), cosine = std::cos(s.steer), length = car.wheelbase();
  CarState d = rates(s, s.yaw, u);
  d.yaw = s.speed / length * tangent;
  d.yaw_rate = u.acceleration / length * tangent + s.speed / (length * cosine * cosine) * u.steer_rate;
  return d;
}

/// Axle loads over the mass, times the wheelbase: m^2/s^2.
struct Loads {
  double front, rear;
};

Loads loads(const CarParameters& car, double acceleration) {
  return {gravity * car.rear_length - acceleration * car.gravity_height,
          gravity * car.front_length + acceleration * car.gravity_height};
}

CarState single_track(const CarParameters& car, const CarState& s, const DriveInput& u, bool gym_reverse) {
  const double lf = car.front_length, lr = car.rear_length, length = car.wheelbase();
  const auto [load_front, load_rear] = loads(car, u.acceleration);
  const double front = car.cornering_front * load_front, rear = car.cornering_rear * load_rear;
  // In reverse the wheels meet the road from behind: every tyre force turns round.
  const double way = gym_reverse ? 1.0 : sign(s.speed);
  const double torque = way * car.friction * car.mass / (car.inertia * length);
  const double force = way * car.friction / (s.speed * length);
  CarState d = rates(s, s.slip + s.yaw, u);
  d.yaw = s.yaw_rate;
  d.yaw_rate = torque * (-(lf * lf * front + lr * lr * rear) / s.speed * s.yaw_rate +
                         (lr * rear - lf * front) * s.slip + lf * front * s.steer);
  d.slip = (force / s.speed * (rear * lr - front * lf) - 1) * s.yaw_rate - force * (rear + front) * s.slip +
           force * front * s.steer;
  return d;
}

/// Sideways force over mu F_z of a tyre of stiffness `cornering` at slip angle `alpha`.
double magic_formula(double cornering, double alpha) {
  constexpr double shape = 1.5;
  return std::sin(shape * std::atan(cornering / shape * alpha));
}

CarState saturating(const CarParameters& car, const CarState& s, const DriveInput& u) {
  const double lf = car.front_length, lr = car.rear_length, length = car.wheelbase();
  const auto [load_front, load_rear] = loads(car, u.acceleration);
  const double along = s.speed * std::cos(s.slip), across = s.speed * std::sin(s.slip);
  const double way = sign(along), rolling = std::max(std::abs(along), kinematic_below / 2);
  const double share = std::min(1.0, std::abs(u.acceleration) / (car.friction * gravity));
  const double grip = car.friction * std::sqrt(1 - share * share) / length;
  const double alpha_front = s.steer * way - std::atan2(across + lf * s.yaw_rate, rolling);
  const double alpha_rear = -std::atan2(across - lr * s.yaw_rate, rolling);
  // Forces over the mass: m/s^2.
  const double front = grip * std::max(0.0, load_front) * magic_formula(car.cornering_front, alpha_front);
  const double rear = grip * std::max(0.0, load_rear) * magic_formula(car.cornering_rear, alpha_rear);
  const double sine = std::sin(s.slip), cosine = std::cos(s.slip);
  CarState d = rates(s, s.slip + s.yaw, u);
  d.speed = u.acceleration * cosine - front * std::sin(s.steer - s.slip) + rear * sine;
  d.yaw = s.yaw_rate;
  d.yaw_rate = car.mass / car.inertia * (lf * front * std::cos(s.steer) - lr * rear);
  d.slip =
      (-u.acceleration * sine + front * std::cos(s.steer - s.slip) + rear * cosine) / s.speed - s.yaw_rate;
  return d;
}

bool is_kinematic(const DynamicsOptions& options, double speed) {
  return options.model == Model::kinematic || std::abs(speed) < kinematic_below;
}

CarState plus(const CarState& s, double t, const CarState& d) {
  return {s.x + t * d.x,         s.y + t * d.y,     s.steer + t * d.steer,
          s.speed + t * d.speed, s.yaw + t * d.yaw, s.yaw_rate + t * d.yaw_rate,
          s.slip + t * d.slip};
}

CarState integrate(const CarParameters& car, const DynamicsOptions& options, const CarState& s,
                   const DriveInput& u, double dt) {
  const CarState k1 = derivative(car, options, s, u);
  if (options.integrator == Integrator::euler) return plus(s, dt, k1);
  const CarState k2 = derivative(car, options, plus(s, dt / 2, k1), u);
  const CarState k3 = derivative(car, options, plus(s, dt / 2, k2), u);
  const CarState k4 = derivative(car, options, plus(s, dt, k3), u);
  return plus(s, dt / 6, plus(plus(plus(k1, 2, k2), 2, k3), 1, k4));
}

/// The steering rate that the actuator allows: none further outwards at its limit.
double limit_steer_rate(const CarParameters& car, double steer, double rate) {
  if ((steer <= car.steer_min && rate <= 0) || (steer >= car.steer_max && rate >= 0)) return 0;
  return std::clamp(rate, -car.steer_rate_max, car.steer_rate_max);
}

/// The acceleration that motor and brakes allow: none beyond the limits of speed, less above switch_speed.
double limit_acceleration(const CarParameters& car, double speed, double acceleration) {
  if ((speed <= car.speed_min && acceleration <= 0) || (speed >= car.speed_max && acceleration >= 0))
    return 0;
  const double drive =
      speed > car.switch_speed ? car.acceleration_max * car.switch_speed / speed : car.acceleration_max;
  return std::clamp(acceleration, -car.acceleration_max, drive);
}

}  // namespace

CarParameters CarParameters::full_scale() {
  return {.cornering_front = 20.898083706740398,
          .cornering_rear = 20.898083706740398,
          .front_length = 1.1561957064,
          .rear_length = 1.4227170936,
          .gravity_height = 0.61373004,
          .mass = 1093.2952334674046,
          .inertia = 1791.5995300122856,
          .steer_min = -1.066,
          .steer_max = 1.066,
          .steer_rate_max = 0.4,
          .acceleration_max = 11.5,
          .speed_min = -13.6,
          .speed_max = 50.8,
          .length = 4.508,
          .width = 1.610};
}

CarState derivative(const CarParameters& car, const DynamicsOptions& options, const CarState& s,
                    const DriveInput& input) noexcept {
  const DriveInput u{limit_steer_rate(car, s.steer, input.steer_rate),
                     limit_acceleration(car, s.speed, input.acceleration)};
  if (is_kinematic(options, s.speed)) return options.gym ? gym_kinematic(car, s, u) : kinematic(car, s, u);
  if (options.model == Model::saturating) return saturating(car, s, u);
  return single_track(car, s, u, options.gym);
}

CarState advance(const CarParameters& car, const DynamicsOptions& options, const CarState& state,
                 const DriveInput& input, double time_step) noexcept {
  const int parts = substeps(car, options, time_step);
  CarState s = state;
  for (int i = 0; i < parts; ++i) {
    s = integrate(car, options, s, input, time_step / parts);
    // The actuator's stop is hard, and its last move may have been longer than the way to it.
    if (!options.gym) s.steer = std::clamp(s.steer, car.steer_min, car.steer_max);
    if (!options.gym && is_kinematic(options, s.speed)) {
      s.yaw_rate = kinematic(car, s, {}).yaw;
      s.slip = std::atan(car.rear_length * std::tan(s.steer) / car.wheelbase());
    }
  }
  return s;
}

int substeps(const CarParameters& car, const DynamicsOptions& options, double time_step) noexcept {
  if (options.substeps > 0) return options.substeps;
  if (options.model == Model::kinematic) return 1;
  // The faster of the decays of yaw rate and slip at the lowest speed of the tyre model.
  const double lf = car.front_length, lr = car.rear_length, length = car.wheelbase();
  const double front = car.cornering_front * gravity * lr, rear = car.cornering_rear * gravity * lf;
  const double scale = car.friction / (kinematic_below * length);
  const double yaw_decay = scale * car.mass / car.inertia * (lf * lf * front + lr * lr * rear);
  const double slip_decay = scale * (front + rear);
  const double stable = options.integrator == Integrator::euler ? 1.0 : 2.4;  // below the bounds 2 and 2.785
  return std::max(1, saturate_cast<int>(std::ceil(time_step * std::max(yaw_decay, slip_decay) / stable)));
}

}  // namespace slalom::sim
