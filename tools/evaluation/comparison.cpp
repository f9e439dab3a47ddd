#include "tools/evaluation/comparison.hpp"

#include <cstdlib>
#include <map>

#include "json/json.hpp"
#include "tools/command_line/words.hpp"

namespace slalom::tools {
namespace {

using namespace evaluation;

constexpr double level = 0.05;  // below it a difference is significant

bool is_weight(const std::string& option) {
  return option.ends_with("_weight") || option.ends_with("_cost") || option == "objective";
}

/// The weights of an experiment by the names of their options; numbers in one notation.
std::map<std::string, std::string> weights_of(const Json& settings, const Experiment& experiment) {
  std::map<std::string, std::string> weights;
  const auto add = [&](const std::string& option, const std::string& text) {
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    weights[option] = end != text.c_str() && *end == '\0' ? short_number(number) : text;
  };
  const Json options = settings.value("options", Json::object()).value("vehicle", Json::object());
  for (const auto& [option, value] : options.items())
    if (is_weight(option)) add(option, value.is_string() ? value.get<std::string>() : json_text(value));
  constexpr std::string_view section = "vehicle.";
  for (const auto& [key, value] : experiment.set)
    if (key.starts_with(section) && is_weight(key)) add(key.substr(section.size()), value);
  return weights;
}

}  // namespace

bool same_weights(const Json& settings_a, const Experiment& a, const Json& settings_b, const Experiment& b) {
  return weights_of(settings_a, a) == weights_of(settings_b, b);
}

std::string p_words(double p) {
  return p < 0.001 ? "p < 0.001" : formatted("p = %.3f", p);
}

std::string p_text(const std::optional<double>& p) {
  if (!p || !std::isfinite(*p)) return "-";
  return *p < 0.001 ? "< 0.001 *" : formatted("%.3f%s", *p, *p < level ? " *" : "");
}

Json interval_json(const std::optional<Interval>& i) {
  return i ? Json{i->low, i->high} : Json(nullptr);
}

Json result_json(const ExperimentResult& r) {
  const auto of_many = [](int laps, const Interval& interval) {
    return interval_json(laps >= fewest_laps ? std::optional(interval) : std::nullopt);
  };
  return {{"laps", r.laps},
          {"finished", r.finished},
          {"timeouts", r.timeouts},
          {"success_rate", r.success_rate},
          {"success_rate_ci", interval_json(r.success_rate_ci)},
          {"collisions", r.collisions},
          {"collision_rate", r.collision_rate ? Json(*r.collision_rate) : Json(nullptr)},
          {"collision_rate_ci", interval_json(r.collision_rate_ci)},
          {"collision_rate_bootstrap_ci", interval_json(r.collision_rate_bootstrap_ci)},
          {"time_mean", r.time_mean},
          {"time_ci", of_many(r.finished, r.time_ci)},
          {"ms_mean", r.ms_mean},
          {"ms_ci", of_many(r.laps, r.ms_ci)},
          {"state_cost_mean", r.state_cost_mean},
          {"collision_cost_mean", r.collision_cost_mean},
          {"solve_ms",
           {{"mean", r.solve_mean}, {"p50", r.solve_p50}, {"p99", r.solve_p99}, {"max", r.solve_max}}}};
}

Json comparison_json(const Comparison& c) {
  return {{"paired", c.paired},
          {"laps", c.laps},
          {"only_a_succeeds", c.only_a_succeeds},
          {"only_b_succeeds", c.only_b_succeeds},
          {"success_p", c.success_p},
          {"collisions_p", c.collisions_p},
          {"time_difference", c.time_difference},
          {"time_p", c.time_p},
          {"ms_difference", c.ms_difference},
          {"ms_p", c.ms_p ? Json(*c.ms_p) : Json(nullptr)}};
}

std::string verdict(const std::array<std::string, 2>& names, const std::array<ExperimentResult, 2>& results,
                    const Comparison& c) {
  struct Finding {
    std::size_t better;
    std::function<std::string(const ExperimentResult& own, const ExperimentResult& other)> words;
  };
  std::vector<Finding> findings;
  const auto find = [&](double p, double difference,
                        auto words) {  // a positive difference speaks for the second
    if (p >= level || !(difference != 0)) return;
    findings.push_back({difference > 0 ? 1U : 0U, [p, words](const auto& own, const auto& other) {
                          return words(own, other) + " (" + p_words(p) + ")";
                        }});
  };
  const auto& [a, b] = results;
  find(c.success_p, b.success_rate - a.success_rate, [](const auto& own, const auto& other) {
    return formatted("succeeds in %.1f instead of %.1f %% of the laps", 100 * own.success_rate,
                     100 * other.success_rate);
  });
  find(c.collisions_p, a.collisions - b.collisions, [](const auto& own, const auto& other) {
    return formatted("has %d instead of %d collisions", own.collisions, other.collisions);
  });
  find(c.time_p, c.time_difference, [d = std::abs(c.time_difference)](const auto& own, const auto& other) {
    return formatted("is %.2f s a lap (%.1f %%) %s", d, 100 * d / other.time_mean,
                     own.time_mean < other.time_mean ? "faster" : "slower");
  });
  if (c.ms_p)
    find(*c.ms_p, c.ms_difference, [](const auto& own, const auto& other) {
      return formatted("has an MS of %.3g instead of %.3g", own.ms_mean, other.ms_mean);
    });
  if (findings.empty())
    return formatted(
        "No difference between %s and %s is significant: success %.1f and %.1f %%, %d and %d collisions, "
        "%.2f and %.2f s a lap.",
        names[0].c_str(), names[1].c_str(), 100 * a.success_rate, 100 * b.success_rate, a.collisions,
        b.collisions, a.time_mean, b.time_mean);
  const std::size_t better = findings.front().better;
  std::string text = names[better] + " is better than " + names[1 - better] + ": it ";
  for (const bool for_it : {true, false})
    for (const Finding& each : findings)
      if ((each.better == better) == for_it)
        text += (&each == &findings.front() ? ""
                 : for_it                   ? ", "
                                            : ", but ") +
                each.words(results[better], results[1 - better]);
  return text + ".";
}

}  // namespace slalom::tools
