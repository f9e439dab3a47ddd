// A method of one's own (predictive_sampling.hpp) solves a problem through the same `Controller` as the
// methods of the library.

#include <cmath>

#include <slalom/problems/pendulum.hpp>
#include <slalom/slalom.hpp>

#include "predictive_sampling.hpp"
#include "seeds.hpp"

using slalom::problems::Pendulum;

int main() {
  const int count = succeeded([](auto seed) {
    slalom::Controller controller{
        Pendulum{}, PredictiveSamplingOptions{
                        .horizon = 60, .variance = 1, .input_min = -5, .input_max = 5, .seed = seed}};
    Pendulum::State<double> x{0.4, 0};
    for (int k = 0; k < 200; ++k)
      x = Pendulum{}.step(x, controller.solve(x, {.elapsed = Pendulum{}.dt}).inputs[0]);
    return std::abs(x.angle) < 0.1 && std::abs(x.rate) < 0.3;
  });
  std::printf("the pendulum stays upright: predictive_sampling %d of 20 seeds\n", count);
  return count == 20 ? 0 : 1;
}
