#include "view/session/work_limit.hpp"

#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "slalom/core/option_access.hpp"

namespace slalom::view {
namespace {

/// The value of an option of a method; `otherwise` if the method has no such option.
double number(const vehicle::Section& section, const std::string& option, double otherwise) {
  for (const OptionEntry& entry : section.options)
    if (entry.declaration.name == option) return std::strtod(to_text(entry.value).c_str(), nullptr);
  return otherwise;
}

}  // namespace

double rollout_steps(const vehicle::Configuration& configuration, const std::string& method) {
  for (const vehicle::Section& section : vehicle::list_sections(configuration)) {
    if (section.name != method) continue;
    const double samples = number(section, "samples", 1),
                 gradient_samples = number(section, "gradient_samples", 0);
    const double guides = number(section, "guides", 0);
    double sequences = samples * number(section, "iterations", 1) * number(section, "inflation", 1);
    if (guides > 0)
      sequences += guides * number(section, "guide_iterations", 1) * gradient_samples;
    else if (gradient_samples > 0)
      sequences *= gradient_samples +
                   samples / 8;  // each sample is a particle: its gradient, and a pair with each other
    return number(section, "horizon", 1) * sequences;
  }
  return 0;
}

void check_work(const vehicle::Configuration& configuration, const std::string& method) {
  const double steps = rollout_steps(configuration, method);
  if (steps <= max_rollout_steps) return;
  throw std::invalid_argument(
      method + ": a solve would take about " + std::to_string(std::llround(steps / 1e6)) +
      " million rollout steps; the live view allows 5 million. Use fewer samples, iterations or "
      "steps of the horizon");
}

}  // namespace slalom::view
