#pragma once

#include <cmath>

#include "slalom/core/option_access.hpp"
#include "src/evaluation/json.hpp"

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

}  // namespace slalom::view
