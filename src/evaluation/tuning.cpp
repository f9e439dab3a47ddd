#include "slalom/evaluation/tuning.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace slalom::evaluation {

namespace {

constexpr double max_weight = 1e12;  // largest weight of a figure: sums stay finite

[[noreturn]] void throw_invalid(const std::string& text, const std::string& rule) {
  throw std::invalid_argument("'" + text + "' " + rule);
}

bool parse_number(std::string_view text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return !text.empty() && error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == at) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// The option of a key; null if there is none.
const OptionEntry* find_option(const std::vector<vehicle::Section>& sections, const std::string& key) {
  for (const auto& section : sections)
    for (const OptionEntry& entry : section.options)
      if (section.name + "." + entry.declaration.name == key) return &entry;
  return nullptr;
}

struct Figure {
  const char* name;
  const char* meaning;
  double (*of)(const LapRow&);
};

constexpr Figure known_figures[] = {
    {"ms", "mean sequence cost of the lap",
     [](const LapRow& row) { return row.state_cost + row.collision_cost; }},
    {"log_ms", "its natural logarithm, which a few bad laps do not dominate",
     [](const LapRow& row) { return std::log(1e-3 + row.state_cost + row.collision_cost); }},
    {"state_cost", "its part from distance and heading", [](const LapRow& row) { return row.state_cost; }},
    {"collision_cost", "its part from collisions", [](const LapRow& row) { return row.collision_cost; }},
    {"ms_driven", "the same cost of the driven states", [](const LapRow& row) { return row.ms_driven; }},
    {"contacts", "number of collisions",
     [](const LapRow& row) { return static_cast<double>(row.collisions); }},
    {"failures", "1 for a lap that did not succeed",
     [](const LapRow& row) { return static_cast<double>(!row.success); }},
    {"timeouts", "1 for a lap that timed out",
     [](const LapRow& row) { return static_cast<double>(row.timeout); }},
    {"lap_time", "s; of a lap that timed out, until then", [](const LapRow& row) { return row.lap_time; }},
    {"path_distance", "mean distance to the path, m",
     [](const LapRow& row) { return row.mean_path_distance; }},
};

}  // namespace

std::string SearchDimension::value(double place) const {
  const double at = std::clamp(place, 0.0, 1.0);
  if (!choices.empty()) {
    const auto i = static_cast<std::size_t>(at * static_cast<double>(choices.size()));
    return choices[std::min(i, choices.size() - 1)];
  }
  char text[40];
  if (whole && !logarithmic) {
    std::snprintf(text, sizeof text, "%.0f", std::min(high, std::floor(low + at * (high - low + 1))));
    return text;
  }
  const double number =
      logarithmic ? std::exp(std::log(low) + at * (std::log(high) - std::log(low))) : low + at * (high - low);
  std::snprintf(text, sizeof text, whole ? "%.0f" : "%.5g", std::clamp(number, low, high));
  return text;
}

double SearchDimension::place(const std::string& value) const {
  if (!choices.empty()) {
    const auto found = std::find(choices.begin(), choices.end(), value);
    const auto i = found == choices.end() ? 0 : found - choices.begin();
    return (static_cast<double>(i) + 0.5) / static_cast<double>(choices.size());
  }
  double number = low;
  parse_number(value, number);
  number = std::clamp(number, low, high);
  if (logarithmic) return std::log(number / low) / std::log(high / low);
  return whole ? (number - low + 0.5) / (high - low + 1) : (number - low) / (high - low);
}

std::string option_text(const vehicle::Configuration& configuration, const std::string& key) {
  const auto sections = vehicle::list_sections(configuration);
  const OptionEntry* entry = find_option(sections, key);
  return entry ? to_text(entry->value) : "";
}

SearchDimension parse_dimension(const std::string& text, const vehicle::Configuration& configuration,
                                const std::string& method) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw_invalid(text, "must be key=lo:hi, key=lo:hi:log or key=v1,v2,...");
  SearchDimension dimension;
  dimension.key = text.substr(0, equals);
  if (dimension.key.find('.') == std::string::npos) dimension.key = method + "." + dimension.key;
  const std::string range = text.substr(equals + 1);
  vehicle::Configuration trial = configuration;
  if (range.find(':') == std::string::npos) {
    dimension.choices = split(range, ',');
    if (dimension.choices.size() < 2) throw_invalid(text, "must give a range lo:hi or at least two values");
    for (const auto& choice : dimension.choices) vehicle::set_option(trial, dimension.key, choice);
    return dimension;
  }
  const auto parts = split(range, ':');
  dimension.logarithmic = parts.size() == 3 && parts[2] == "log";
  if (parts.size() > 3 || (parts.size() == 3 && !dimension.logarithmic) ||
      !parse_number(parts[0], dimension.low) || !parse_number(parts[1], dimension.high) ||
      !(dimension.low < dimension.high))
    throw_invalid(text, "must be key=lo:hi or key=lo:hi:log with numbers lo < hi");
  if (!std::isfinite(dimension.high - dimension.low)) throw_invalid(text, "must have a finite range hi - lo");
  if (dimension.logarithmic && !(dimension.low > 0)) throw_invalid(text, "must have lo > 0 with log");
  if (dimension.logarithmic && !std::isfinite(dimension.high / dimension.low))
    throw_invalid(text, "must have a finite ratio hi / lo with log");
  const auto sections = vehicle::list_sections(configuration);
  if (const OptionEntry* entry = find_option(sections, dimension.key)) {
    dimension.whole =
        std::holds_alternative<int>(entry->value) || std::holds_alternative<std::uint64_t>(entry->value);
  }
  if (dimension.whole &&
      (dimension.low != std::floor(dimension.low) || dimension.high != std::floor(dimension.high)))
    throw_invalid(text, "must have whole numbers as its ends, since the option is one");
  // Reports unknown keys and ends out of range.
  for (const double place : {0.0, 1.0}) vehicle::set_option(trial, dimension.key, dimension.value(place));
  return dimension;
}

std::vector<Candidate> design(const std::vector<SearchDimension>& dimensions,
                              const std::vector<double>& centre, double width, int first, int count) {
  // x^(d+1) = x + 1
  double ratio = 2;
  for (int i = 0; i < 60; ++i) ratio = std::pow(1 + ratio, 1 / (static_cast<double>(dimensions.size()) + 1));
  std::vector<Candidate> candidates;
  for (int k = first; k < first + count; ++k) {
    Candidate candidate;
    for (std::size_t i = 0; i < dimensions.size(); ++i) {
      const double step = std::pow(ratio, -static_cast<double>(i + 1)), position = 0.5 + (k + 1) * step;
      const double low = std::clamp(centre[i] - width / 2, 0.0, 1 - width);
      candidate.place.push_back(low + width * (position - std::floor(position)));
      candidate.set.emplace_back(dimensions[i].key, dimensions[i].value(candidate.place.back()));
    }
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

std::vector<Rung> halving(int candidates, int laps) {
  std::vector<Rung> rungs;
  for (; candidates >= 2; candidates = (candidates + 1) / 2, laps *= 2) {
    rungs.push_back({candidates, laps});
    if (candidates == 2) break;
  }
  return rungs;
}

int laps_of(const std::vector<Rung>& rungs) {
  int sum = 0, before = 0;
  for (const Rung& rung : rungs) {
    sum += rung.candidates * (rung.laps - before);
    before = rung.laps;
  }
  return sum;
}

int candidates_for(int budget, int laps) {
  int candidates = 1;
  while (laps_of(halving(candidates + 1, laps)) <= budget && candidates < 4096) ++candidates;
  return candidates;
}

Objective::Objective(std::string_view text) {
  const std::string all(text);
  std::string term;
  const auto add_term = [&] {
    // "3*contacts", "3 contacts" or "contacts"
    const auto name_at = term.find_first_of("abcdefghijklmnopqrstuvwxyz_");
    std::string number = term.substr(0, name_at == std::string::npos ? term.size() : name_at);
    const std::string name = name_at == std::string::npos ? "" : term.substr(name_at);
    if (!number.empty() && number.back() == '*') number.pop_back();
    double weight = 1;
    if (!number.empty() && !(parse_number(number, weight) && weight > 0 && weight <= max_weight))
      throw_invalid(all,
                    "must be a sum of figures, each with a weight above 0, at most 1e12, before it or none");
    std::string names;
    for (std::size_t i = 0; i < std::size(known_figures); ++i) {
      names += (i ? ", " : "") + std::string(known_figures[i].name);
      if (name != known_figures[i].name) continue;
      terms_.push_back({weight, i});
      term.clear();
      return;
    }
    throw_invalid(all, "must be a sum of these figures: " + names);
  };
  for (const char c : all) {
    if (c == '+') {
      add_term();
    } else if (c != ' ') {
      term += c;
    }
  }
  add_term();
}

double Objective::of(const LapRow& row) const noexcept {
  double sum = 0;
  for (const Term& term : terms_) sum += term.weight * known_figures[term.figure].of(row);
  return sum;
}

std::vector<std::pair<const char*, const char*>> Objective::figures() {
  std::vector<std::pair<const char*, const char*>> list;
  for (const Figure& figure : known_figures) list.emplace_back(figure.name, figure.meaning);
  return list;
}

}  // namespace slalom::evaluation
