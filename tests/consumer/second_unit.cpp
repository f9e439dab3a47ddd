// A second translation unit with the same headers and another problem: both link.
#include <slalom/problems/pendulum.hpp>
#include <slalom/slalom.hpp>

double second_unit_cost() {
  slalom::Mppi controller{slalom::problems::Pendulum{}, {.horizon = 10, .samples = 64}};
  return controller.solve({1, 0}).cost;
}
