// A pole on a cart is kept upright by plans that are made ten times a second, while somebody pushes the
// cart. Between two plans, the gains of a linear-quadratic regulator along the plan answer the pushes 500
// times a second. They come from the derivatives of the problem.

#include <cmath>
#include <cstdio>
#include <random>

#include <slalom/problems/cart_pole.hpp>
#include <slalom/slalom.hpp>

#include "seeds.hpp"

using slalom::problems::CartPole;

/// Whether the pole stays within 0.5 rad for 10 s.
bool stays_upright(std::uint64_t seed, bool with_feedback) {
  slalom::Mppi controller{CartPole{},
                          {.horizon = 60,
                           .samples = 2048,
                           .temperature = 0.3,
                           .variance = 4,
                           .input_min = {-10},
                           .input_max = {10},
                           .seed = seed}};
  slalom::Feedback feedback{controller};
  CartPole cart;  // the real one, in short steps
  cart.dt = 0.002;
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<double> push(0, 2);  // N, another one every 0.1 s
  CartPole::State<double> x{};
  for (int solve = 0; solve < 100; ++solve) {
    const auto plan = controller.solve(x, {.elapsed = 0.1});
    feedback.update(controller, plan);
    const double force = push(random);
    for (int tick = 0; tick < 50; ++tick) {
      const double t = tick * cart.dt;
      const double u = with_feedback ? feedback.input_at(t, x)[0] : plan.inputs[tick / 10][0];
      x = cart.step(x, {{u + force}});
      if (std::abs(x.angle) > 0.5) return false;
    }
  }
  return true;
}

int main() {
  const int plans = succeeded([](auto seed) { return stays_upright(seed, false); });
  const int feedback = succeeded([](auto seed) { return stays_upright(seed, true); });
  std::printf("the pole stays upright: plans alone %d of 20 seeds, with feedback %d of 20\n", plans,
              feedback);
  return feedback >= 18 && feedback > plans ? 0 : 1;
}
