#pragma once

#include <algorithm>
#include <cmath>

#include "json/json.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/solvers/symptom.hpp"

namespace slalom::view {

/// The declaration of an option, its value, and the value that was loaded, for the page.
inline Json option_json(const OptionEntry& entry, const std::string& loaded) {
  const Declaration& d = entry.declaration;
  Json json = {{"name", d.name},   {"symbol", d.symbol},       {"unit", d.unit},
               {"help", d.help},   {"type", type_name(entry)}, {"value", to_text(entry.value)},
               {"default", loaded}};
  if (std::isfinite(d.min)) json["min"] = d.min;
  if (std::isfinite(d.max)) json["max"] = d.max;
  if (!entry.choices.empty()) json["choices"] = entry.choices;
  return json;
}

/// A rectangle along the axes, m.
struct Bounds {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  /// Grows to include a point.
  void include(double x, double y) {
    x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
  }
};
inline Json bounds_json(const Bounds& b) {
  return {b.x0, b.y0, b.x1, b.y1};
}

/// The size of the driven body, m; `front` and `rear`: distances of the axles, 0 without wheels.
inline Json body_json(double length, double width, double front = 0, double rear = 0) {
  return {{"length", length}, {"width", width}, {"front", front}, {"rear", rear}};
}

/// The names of the values of an enumeration up to `last`.
template <class Enumeration>
Json names_json(Enumeration last) {
  Json names = Json::array();
  for (int i = 0; i <= static_cast<int>(last); ++i) names.push_back(name(static_cast<Enumeration>(i)));
  return names;
}

/// The names of all symptoms of a solve and what they mean, by their values.
inline Json symptoms_json() {
  Json symptoms = Json::array();
  for (int i = 0; i <= static_cast<int>(Symptom::no_progress); ++i) {
    const auto symptom = static_cast<Symptom>(i);
    symptoms.push_back({{"name", name(symptom)}, {"explanation", explanation(symptom)}});
  }
  return symptoms;
}

}  // namespace slalom::view
