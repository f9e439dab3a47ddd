#pragma once

#include "slalom/solvers/symptom.hpp"
#include "src/evaluation/json.hpp"

namespace slalom::view {

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
