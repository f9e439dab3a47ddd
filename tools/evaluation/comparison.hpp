#pragma once

#include <nlohmann/json_fwd.hpp>

#include "slalom/evaluation/results.hpp"

/// Results of experiments and their comparisons in words and as JSON, for `eval`, `compare` and reports.
namespace slalom::tools {

/// Whether two experiments weigh the terms of the car's cost alike: the options `vehicle.*_weight`,
/// `vehicle.*_cost` and `vehicle.objective`. If they do not, their MS does not tell which is better.
/// `settings` are those of the evaluations.
bool same_weights(const nlohmann::ordered_json& settings_a, const evaluation::Experiment& a,
                  const nlohmann::ordered_json& settings_b, const evaluation::Experiment& b);

/// A p value in a sentence.
std::string p_words(double p);
/// A p value, with a star below 0.05; "-" for none.
std::string p_text(const std::optional<double>& p);

/// An interval as [low, high], or null.
nlohmann::ordered_json interval_json(const std::optional<evaluation::Interval>& interval);
/// The figures of an experiment: numbers of laps, rates and means with their intervals.
nlohmann::ordered_json result_json(const evaluation::ExperimentResult& result);
/// The differences a - b and the p values of a comparison.
nlohmann::ordered_json comparison_json(const evaluation::Comparison& comparison);

/// A sentence: which of the two is better, and by how much. Of the figures that differ at the 5 % level the
/// first of success, collisions, lap time and MS decides; the others follow.
std::string verdict(const std::array<std::string, 2>& names,
                    const std::array<evaluation::ExperimentResult, 2>& results,
                    const evaluation::Comparison& comparison);

}  // namespace slalom::tools
