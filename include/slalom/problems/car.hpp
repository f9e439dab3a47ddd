#pragma once

#include "slalom/core/options.hpp"
#include "slalom/core/problem.hpp"

namespace slalom::problems {

/// A car that steers and accelerates (kinematic bicycle about its rear axle) on a straight road with two cars
/// parked in the middle: pass them on either side and stop at a line.
/// `visit_options` below describes the fields.
struct Car {
  /// State of the dynamics.
  template <class T>
  struct State {
    T x, y, yaw, speed;  ///< m, m, rad, m/s
  };
  static constexpr int inputs = 2;  ///< steering angle, rad; acceleration, m/s^2
  double dt = 0.1;
  double wheelbase = 2.7;
  double cruise = 8;
  double stop_x = 80;
  double half_road = 4;
  std::array<double, 2> parked_x{25, 50}, parked_y{0.2, -0.3};  ///< parked cars of 4.5 m x 2 m; m

  /// State after one step.
  template <class T>
  State<T> step(const State<T>& x, const Input<T, 2>& u) const {
    T s, c;
    sin_cos(x.yaw, s, c);
    const T speed = max(x.speed + T(dt) * u[1], T(0));
    return {x.x + T(dt) * speed * c, x.y + T(dt) * speed * s, x.yaw + T(dt / wheelbase) * speed * tan(u[0]),
            speed};
  }
  /// Cost of a step.
  template <class T>
  Cost<T> stage_cost(const State<T>& x, const Input<T, 2>& u) const {
    const auto hit = hits(x);
    const T wanted = clamp((T(stop_x) - x.x) * T(0.5), T(0), T(cruise));
    const T cost = T(0.3) * square(x.speed - wanted) + T(0.05) * x.y * x.y + T(5) * x.yaw * x.yaw +
                   T(10) * u[0] * u[0] + T(0.05) * u[1] * u[1];
    return {T(dt) * cost + select(hit, T(100), T(0)), hit};
  }
  /// Cost of the last state.
  template <class T>
  T terminal_cost(const State<T>&) const {
    return T(0);
  }

  /// Whether the car, 1.8 m wide, 4.5 m long and taken as parallel to the road, collides with a parked car or
  /// the edge of the road.
  template <class T>
  mask_t<T> hits(const State<T>& x) const {
    mask_t<T> hit = abs(x.y) > T(half_road - 0.9);
    for (std::size_t i = 0; i < parked_x.size(); ++i) {
      const T beyond = max(abs(x.x + T(1.3) - T(parked_x[i])) - T(4.5), abs(x.y - T(parked_y[i])) - T(1.9));
      hit = hit | (beyond < T(0));
    }
    return hit;
  }
};

template <class Parameters, class Visit>
requires is_options_of<Parameters, Car>
void visit_options(Parameters& p, Visit&& visit) {
  visit(p.dt, {"dt", "s", "duration of a step", 0.001, 1});
  visit(p.wheelbase, {"wheelbase", "m", "distance between the axles", 0.1, 100});
  visit(p.cruise, {"cruise", "m/s", "speed on a free road", 0, 100});
  visit(p.stop_x, {"stop_x", "m", "position along the road where the car stops", -1e+06, 1e+06});
  visit(p.half_road, {"half_road", "m", "half of the width of the road", 1, 100});
}

}  // namespace slalom::problems
