// A quadrotor in the plane, a wall with two gaps: fly through one of them and hover behind it.

#include <cmath>

#include <slalom/problems/quadrotor.hpp>
#include <slalom/slalom.hpp>

#include "seeds.hpp"

using slalom::problems::Quadrotor;

/// Whether the quadrotor hovers within 1 m of its goal after 8 s and never collided with the wall.
template <class Controller>
bool arrives(Controller controller) {
  const Quadrotor& quadrotor = controller.problem();
  Quadrotor::State<double> x{0, 0, 0, 0, 0, 0};
  for (double t = 0; t < 8; t += quadrotor.dt) {
    x = quadrotor.step(x, controller.solve(x, {.elapsed = quadrotor.dt}).inputs[0]);
    if (quadrotor.hits_wall(x)) return false;
  }
  return quadrotor.distance(x) < 1;
}

int main() {
  int failed = 0;
  for (const double temperature : {0.3, 1.0}) {
    const int mppi = succeeded([&](auto seed) {
      return arrives(slalom::Mppi{Quadrotor{},
                                  {.horizon = 40,
                                   .samples = 2048,
                                   .temperature = temperature,
                                   .variance = {2, 8},
                                   .input_min = {-6, -20},
                                   .input_max = {6, 20},
                                   .seed = seed}});
    });
    const int svg_mppi = succeeded([&](auto seed) {
      return arrives(slalom::SvgMppi{Quadrotor{},
                                     {.horizon = 40,
                                      .samples = 2048,
                                      .temperature = temperature,
                                      .input_min = {-6, -20},
                                      .input_max = {6, 20},
                                      .guides = {.step = {0.5, 2},
                                                 .variance = {1, 4},
                                                 .gradient_variance = {1, 4},
                                                 .gradient_temperature = temperature},
                                      .variance_min = {0.5, 2},
                                      .variance_max = {2, 8},
                                      .seed = seed}});
    });
    std::printf("temperature %g, ", temperature);
    failed += report("the quadrotor hovers behind the wall", mppi, svg_mppi, 19, true);
  }
  return failed;
}
