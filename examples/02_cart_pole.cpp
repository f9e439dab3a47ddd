// A pole on a cart: swing the pole up by pushing the cart, and keep the cart on its track.

#include <cmath>
#include <numbers>

#include <slalom/problems/cart_pole.hpp>
#include <slalom/slalom.hpp>

#include "seeds.hpp"

using slalom::problems::CartPole;

/// Whether the pole is upright 6 s after it started hanging down, and the cart never left its track.
template <class Controller>
bool stands(Controller controller) {
  const CartPole& cart = controller.problem();
  CartPole::State<double> x{0, 0, std::numbers::pi, 0};
  for (double t = 0; t < 6; t += cart.dt) {
    x = cart.step(x, controller.solve(x, {.elapsed = cart.dt}).inputs[0]);
    if (std::abs(x.position) > cart.track) return false;
  }
  return std::cos(x.angle) > 0.99 && std::abs(x.rate) < 0.5;
}

int main() {
  const int mppi = succeeded([](auto seed) {
    return stands(slalom::Mppi{CartPole{},
                               {.horizon = 60,
                                .samples = 4096,
                                .temperature = 0.1,
                                .variance = 8,
                                .input_min = {-10},
                                .input_max = {10},
                                .seed = seed}});
  });
  const int svg_mppi = succeeded([](auto seed) {
    return stands(slalom::SvgMppi{
        CartPole{},
        {.horizon = 60,
         .samples = 4096,
         .temperature = 0.1,
         .input_min = {-10},
         .input_max = {10},
         .guides = {.step = 0.2, .variance = 4, .gradient_variance = 2, .gradient_temperature = 0.1},
         .variance_min = 4,
         .variance_max = 8,
         .seed = seed}});
  });
  return report("the pole stands", mppi, svg_mppi, 20);
}
