// A car that steers and accelerates: pass parked cars on either side and stop at the line.

#include <cmath>

#include <slalom/problems/car.hpp>
#include <slalom/slalom.hpp>

#include "seeds.hpp"

using slalom::problems::Car;

/// Whether the car stands at the line after 20 s and had no collision.
template <class Controller>
bool arrives(Controller controller) {
  const Car& car = controller.problem();
  Car::State<double> x{0, 0, 0, 5};
  for (double t = 0; t < 20; t += car.dt) {
    x = car.step(x, controller.solve(x, {.elapsed = car.dt}).inputs[0]);
    if (car.hits(x)) return false;
  }
  return std::abs(x.x - car.stop_x) < 1 && x.speed < 0.5;
}

int main() {
  int failed = 0;
  for (const double temperature : {0.3, 1.0}) {
    const int mppi = succeeded([&](auto seed) {
      return arrives(slalom::Mppi{Car{},
                                  {.horizon = 30,
                                   .samples = 2048,
                                   .temperature = temperature,
                                   .variance = {0.1, 2},
                                   .input_min = {-0.5, -6},
                                   .input_max = {0.5, 3},
                                   .seed = seed}});
    });
    const int svg_mppi = succeeded([&](auto seed) {
      return arrives(slalom::SvgMppi{Car{},
                                     {.horizon = 30,
                                      .samples = 2048,
                                      .temperature = temperature,
                                      .input_min = {-0.5, -6},
                                      .input_max = {0.5, 3},
                                      .guides = {.step = {0.025, 0.5},
                                                 .variance = {0.05, 1},
                                                 .gradient_variance = {0.05, 1},
                                                 .gradient_temperature = 0.3},
                                      .variance_min = {0.02, 0.4},
                                      .variance_max = {0.1, 2},
                                      .seed = seed}});
    });
    std::printf("temperature %g, ", temperature);
    failed += report("the car stops at the line", mppi, svg_mppi, 19, true);
  }
  return failed;
}
