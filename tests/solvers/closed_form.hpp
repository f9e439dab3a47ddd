#pragma once

#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"

namespace slalom::testing {

/// `svg_mppi` as a closed form for inputs of order one: white noise in one batch, nothing adapts.
inline SvgMppiOptions closed_form(double temperature) {
  SvgMppiOptions o{.batches = 1};
  o.temperature = o.guides.gradient_temperature = temperature;
  o.variance = o.variance_max = o.guides.variance = o.guides.restart_variance = 1;
  o.variance_min = 0.01;
  o.guides.count = 4;
  o.guides.iterations = 10;
  o.guides.gradient_samples = 25;
  o.guides.step = 0.125;
  o.guides.gradient_variance = 0.25;
  o.noise.exponent = 0;
  return o;
}

/// `mppi` with its control term.
inline MppiOptions with_control_term(double temperature) {
  return {.temperature = temperature, .variance = 1, .control_cost_discount = 0};
}

}  // namespace slalom::testing
