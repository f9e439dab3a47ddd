// An arm with seven joints reaches past a ball: over it, under it or behind it.

#include <algorithm>

#include <slalom/problems/arm.hpp>
#include <slalom/slalom.hpp>

#include "seeds.hpp"

using slalom::problems::Arm;

/// Whether the hand comes within 5 cm of its goal within 8 s and no link collides with the ball or the
/// ground.
template <class Controller>
bool arrives(Controller controller) {
  const Arm& arm = controller.problem();
  Arm::State<double> x;
  std::copy(Arm::start.begin(), Arm::start.end(), x.angle);
  for (double t = 0; t < 8; t += arm.dt) {
    x = arm.step(x, controller.solve(x, {.elapsed = arm.dt}).inputs[0]);
    if (arm.collides(arm.posture(x))) return false;
    if (arm.distance(arm.posture(x)) < 0.05) return true;
  }
  return false;
}

int main() {
  int failed = 0;
  for (const double temperature : {0.3, 1.0}) {  // the problem has bounds on its inputs and their rates
    const int mppi = succeeded([&](auto seed) {
      return arrives(slalom::Mppi{
          Arm{},
          {.horizon = 20, .samples = 1024, .temperature = temperature, .variance = 0.5, .seed = seed}});
    });
    const int svg_mppi = succeeded([&](auto seed) {
      return arrives(slalom::SvgMppi{Arm{},
                                     {.horizon = 20,
                                      .samples = 1024,
                                      .temperature = temperature,
                                      .guides = {.step = 0.025,
                                                 .variance = 0.05,
                                                 .gradient_variance = 0.05,
                                                 .gradient_temperature = temperature},
                                      .variance_min = 0.06,
                                      .variance_max = 0.25,
                                      .seed = seed}});
    });
    std::printf("temperature %g, ", temperature);
    failed += report("the hand arrives", mppi, svg_mppi, 20, true);
  }
  return failed;
}
