#pragma once

#include <cstdint>

namespace slalom {

/// A likely reason for poor plans, which a solver sees in its own samples. docs/my-robot-does-not.md says
/// more about each.
enum class Symptom : std::uint8_t {
  none,              ///< nothing stands out
  few_samples,       ///< the effective sample size is below 3
  equal_costs,       ///< the costs of the samples hardly differ
  samples_diverge,   ///< half of the costs are not finite, or beyond 1e9 times the highest cost of a plan
  small_variance,    ///< samples hardly deviate, beside the range of the inputs
  saturated_inputs,  ///< nine of ten inputs of the plan are within 10 % of the range of a bound
  noisy_plan,        ///< the first input swings from solve to solve, by a fifth of its range
  no_progress,       ///< the least cost neither falls nor rises, and is not small
};

/// The name of a symptom, as it is written in results.
constexpr const char* name(Symptom symptom) noexcept {
  constexpr const char* names[] = {"none",           "few_samples",      "equal_costs", "samples_diverge",
                                   "small_variance", "saturated_inputs", "noisy_plan",  "no_progress"};
  return names[static_cast<int>(symptom)];
}

/// A sentence about a symptom: its sign, its meaning, and a remedy. Empty for `none`.
constexpr const char* explanation(Symptom symptom) noexcept {
  constexpr const char* sentences[] = {
      "",
      "the effective sample size is below 3, so plans follow single samples: leave the temperature at 0, or "
      "raise it, or draw more samples",
      "the costs of the samples hardly differ, so plans are averages of all samples: leave the temperature "
      "at 0, or lower it; leave out large constant costs; let the cost depend on the inputs",
      "half of the samples cost more than anything meant, or are not finite, so the model runs away within "
      "the horizon: take smaller steps of time, shorten the horizon, or limit the state",
      "the standard deviation of the samples is below a hundredth of the inputs' range, so plans change "
      "slowly: leave the variance at 0, or raise it",
      "nine of ten inputs of the plan are near a bound: widen the bounds, raise the cost of inputs, or "
      "accept that the task takes all that the inputs can do",
      "the first input swings from solve to solve, so the robot trembles: draw more samples, shorten the "
      "horizon, or use svg_mppi, whose noise becomes fine",
      "the least cost has stayed the same, so the robot has arrived, or the horizon ends before the way out: "
      "lengthen the horizon, or let the terminal cost say how much remains"};
  return sentences[static_cast<int>(symptom)];
}

}  // namespace slalom
