// A method of one's own (predictive_sampling.hpp) solves a problem through the same `Controller` as the
// methods of the library.

#include <cmath>

#include <slalom/slalom.hpp>

#include "predictive_sampling.hpp"
#include "seeds.hpp"

struct Point {  // pushed about in the plane
  template <class T>
  struct State {
    T x, y, speed_x, speed_y;  // m, m/s
  };
  static constexpr int inputs = 2;  // m/s^2
  double dt = 0.1;                  // s

  template <class T>
  State<T> step(const State<T>& x, const slalom::Input<T, 2>& u) const {
    return {x.x + T(dt) * x.speed_x, x.y + T(dt) * x.speed_y, x.speed_x + T(dt) * u[0],
            x.speed_y + T(dt) * u[1]};
  }
  template <class T>
  T stage_cost(const State<T>& x, const slalom::Input<T, 2>& u) const {
    return x.x * x.x + x.y * x.y + T(0.01) * (u[0] * u[0] + u[1] * u[1]);
  }
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return T(10) * (x.x * x.x + x.y * x.y + x.speed_x * x.speed_x + x.speed_y * x.speed_y);
  }
};

int main() {
  const int count = succeeded([](auto seed) {
    slalom::Controller controller{
        Point{}, PredictiveSamplingOptions{.variance = 0.25, .input_min = -2, .input_max = 2, .seed = seed}};
    Point::State<double> x{2, -1, 0, 0};
    for (int k = 0; k < 100; ++k) x = Point{}.step(x, controller.solve(x, {.elapsed = 0.1}).inputs[0]);
    return std::hypot(x.x, x.y) < 0.15;
  });
  std::printf("the point comes to rest: predictive_sampling %d of 20 seeds\n", count);
  return count == 20 ? 0 : 1;
}
