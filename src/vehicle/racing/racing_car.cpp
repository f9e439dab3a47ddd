#include "slalom/vehicle/racing/racing_car.hpp"

#include "slalom/core/gravity.hpp"
#include "vehicle/course/speed_passes.hpp"
#include "vehicle/require.hpp"

namespace slalom::vehicle {
namespace {

using detail::require;
using detail::require_within;

/// The highest value that holds, by bisection: `low` holds, `high` does not.
template <class Holds>
double highest(double low, double high, const Holds& holds) {
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

RacingCar passenger_car() {
  RacingCar car{.name = "passenger",
                .width = 1.85,
                .margin = 0.3,
                .wheelbase = 2.7,
                .max_steering = 0.5,
                .max_steering_rate = 0.6,
                .limits = {55, 8.5, 5, 8.5}};
  car.power = 75;  // 110 kW, 1500 kg
  return car;
}

}  // namespace

void validate(const RacingCar& car) {
  require_within(0.01, 100, "width", car.width);
  require_within(0, 100, "margin", car.margin);
  require_within(0.01, 100, "wheelbase", car.wheelbase);
  require_within(0.001, 1.5, "max_steering", car.max_steering);
  require_within(0.001, 1e9, "max_steering_rate", car.max_steering_rate);
  detail::require_plausible(car.limits);
  require(car.power >= 0.01, "power", car.power, "at least 0.01");
}

std::vector<std::string> racing_car_names() {
  return {RacingCar{}.name, passenger_car().name};
}

RacingCar racing_car(const std::string& name) {
  for (const RacingCar& car : {RacingCar{}, passenger_car()})
    if (car.name == name) return car;
  std::string names;
  for (const std::string& known : racing_car_names()) names += (names.empty() ? "" : ", ") + known;
  throw std::invalid_argument("car: '" + name + "' must be one of " + names);
}

RacingCar racing_car(const Configuration& configuration) {
  const VehicleOptions& vehicle = configuration.vehicle;
  const auto& tyres = vehicle.own_of<SingleTrackOptions>();
  constexpr double longest_model_car = 1;  // m, wheelbase
  RacingCar car = vehicle.wheelbase() > longest_model_car ? passenger_car() : RacingCar{};
  car.name = "configured";
  car.width = vehicle.body.width;
  car.margin = 3 * vehicle.body.margin;
  car.wheelbase = vehicle.wheelbase();
  car.max_steering = configuration.planner.steer_limit;
  car.max_steering_rate = tyres.steer_rate;
  car.limits = grip_limits(tyres.friction * tyres.usable_grip, car.limits.top_speed, vehicle.max_acceleration,
                           vehicle.max_deceleration);
  car.power = vehicle.max_acceleration * tyres.switch_speed;
  return car;
}

void set_friction(RacingCar& car, double friction) {
  require_within(0.01, 10, "friction", friction);
  const double grip = friction * gravity;
  car.limits.lateral_acceleration = car.limits.acceleration = car.limits.braking = grip;
}

double max_curvature(const RacingCar& car) {
  return std::tan(car.max_steering) / car.wheelbase;
}

std::vector<double> racing_speeds(std::span<const double> curvature, std::span<const double> step,
                                  bool closed, const RacingCar& car) {
  validate(car);
  detail::require_finite(curvature, step);
  const SpeedLimits& limits = car.limits;
  const std::size_t n = curvature.size();
  std::vector<double> speed(n);
  for (std::size_t i = 0; i < n; ++i) {
    speed[i] = std::min(limits.top_speed,
                        std::sqrt(limits.lateral_acceleration / std::max(std::abs(curvature[i]), 1e-9)));
    if (!closed && i + 1 == n) break;
    const double turn = car.wheelbase * std::abs(curvature[(i + 1) % n] - curvature[i]) / step[i];
    if (speed[i] * turn > car.max_steering_rate) speed[i] = car.max_steering_rate / turn;
  }
  const auto braking = [&](double v, double k) {
    return limits.braking * detail::share_left(v, k, limits.lateral_acceleration);
  };
  const auto forwards = [&](double v, double k) {
    return std::min(limits.acceleration * detail::share_left(v, k, limits.lateral_acceleration),
                    car.power / std::max(v, 1e-9));
  };
  // The strongest acceleration of both ends of a piece and of its middle: on a line on which turning takes
  // all grip almost everywhere, that of the start alone is too much for a fifth of the pieces.
  const auto reach = [&](const auto& strongest) {
    return [&](std::size_t from, std::size_t to, double way) {
      const double before = speed[from], first = curvature[from], last = curvature[to];
      const auto holds = [&](double after) {
        const double a = (after * after - before * before) / (2 * way);
        return a <= strongest(before, first) && a <= strongest(after, last) &&
               a <= strongest(0.5 * (before + after), 0.5 * (first + last));
      };
      if (speed[to] > before && !holds(speed[to])) speed[to] = highest(before, speed[to], holds);
    };
  };
  detail::for_each_piece(speed, step, closed, reach(forwards), reach(braking));
  return speed;
}

}  // namespace slalom::vehicle
