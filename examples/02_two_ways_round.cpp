// A robot with two driven wheels and a disc in its way. Left and right are equally good; their average
// collides.

#include <slalom/problems/differential_drive.hpp>
#include <slalom/slalom.hpp>

#include "seeds.hpp"

using slalom::problems::DifferentialDrive;

/// Whether the robot reaches its goal within 12 s without a collision.
template <class Controller>
bool arrives(Controller controller) {
  const DifferentialDrive& robot = controller.problem();
  DifferentialDrive::State<double> x{0, 0, 0};
  for (int k = 0; k < 120; ++k) {
    x = robot.step(x, controller.solve(x, {.elapsed = robot.dt}).inputs[0]);
    if (robot.place_cost(x).collided) return false;
    if (robot.distance(x) < 0.3) return true;
  }
  return false;
}

int main() {
  int failed = 0;
  for (const double temperature : {0.3, 3.0}) {
    const int mppi = succeeded([&](auto seed) {
      return arrives(slalom::Mppi{DifferentialDrive{},
                                  {.horizon = 25,
                                   .samples = 1024,
                                   .temperature = temperature,
                                   .variance = {0.4, 1.6},
                                   .input_min = {0, -2},
                                   .input_max = {1.5, 2},
                                   .seed = seed}});
    });
    const int svg_mppi = succeeded([&](auto seed) {
      return arrives(slalom::SvgMppi{DifferentialDrive{},
                                     {.horizon = 25,
                                      .samples = 1024,
                                      .temperature = temperature,
                                      .input_min = {0, -2},
                                      .input_max = {1.5, 2},
                                      .seed = seed}});
    });
    std::printf("temperature %g, ", temperature);
    failed += report("the robot arrives", mppi, svg_mppi, 20, true);
  }
  return failed;
}
