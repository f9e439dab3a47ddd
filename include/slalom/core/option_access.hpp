#pragma once

#include <variant>

#include "slalom/core/options.hpp"

/// Options by name and as text, for code that does not know their types: configuration files, the command
/// line, bindings, sliders. All follows from the declarations.
namespace slalom {

/// The value of an option of any type; of an enumeration, the enumerator's name.
using OptionValue = std::variant<bool, int, std::uint64_t, double, std::vector<double>, std::string>;

/// An option of an options aggregate: its declaration and its value.
struct OptionEntry {
  Declaration declaration;           ///< the declaration of the option
  OptionValue value;                 ///< the value of the option
  std::vector<std::string> choices;  ///< names of the enumerators if the option is an enumeration

  bool operator==(const OptionEntry& other) const { return value == other.value; }
};

/// "flag", "integer", "number", "numbers" (a PerInput) or "choice".
const char* type_name(const OptionEntry& entry);

/// A value as a configuration file has it: `true`, `12`, `0.05`, `[0.1, 0.2]`, `.inf`, `narrow`.
/// Numbers are written with as few digits as read back to the same value.
std::string to_text(const OptionValue& value);

/// The rule of a declared range, for instance "must be in [1, 4096]".
std::string range_rule(const Declaration& declaration);

namespace detail {

/// Reads a value of the type of the field. Throws std::invalid_argument if the text has another form, or if
/// the value is out of the declared range; the field is unchanged then.
void parse(std::string_view text, const Declaration& declaration, bool& field);
void parse(std::string_view text, const Declaration& declaration, int& field);
void parse(std::string_view text, const Declaration& declaration, std::uint64_t& field);
void parse(std::string_view text, const Declaration& declaration, double& field);
void parse(std::string_view text, const Declaration& declaration, PerInput& field);
void parse(std::string_view text, const Declaration& declaration, const Choice& field);

template <class Field>
OptionValue value_of(const Field& field) {
  if constexpr (std::is_same_v<Field, PerInput>) {
    return field.values();
  } else if constexpr (std::is_same_v<Field, Choice>) {
    return std::string(field.names()[field.index()]);
  } else if constexpr (std::is_enum_v<Field>) {
    return std::string(enum_names(field)[static_cast<int>(field)]);
  } else {
    return field;
  }
}

}  // namespace detail

/// Every option of an aggregate, in the order of their declarations.
template <class Options>
std::vector<OptionEntry> list_options(const Options& options) {
  std::vector<OptionEntry> entries;
  visit_options(options, [&](const auto& field, const Declaration& declaration) {
    using Field = std::remove_cvref_t<decltype(field)>;
    OptionEntry entry{declaration, detail::value_of(field), {}};
    if constexpr (std::is_enum_v<Field>)
      for (const char* const* name = enum_names(field); *name; ++name) entry.choices.emplace_back(*name);
    if constexpr (std::is_same_v<Field, Choice>)
      for (const char* const* name = field.names(); *name; ++name) entry.choices.emplace_back(*name);
    entries.push_back(std::move(entry));
  });
  return entries;
}

/// Sets one option from text. False if there is none of that name. Throws std::invalid_argument with the
/// value and the rule it breaks: "'0' must be in [1, 4096]"; the option is unchanged then.
template <class Options>
bool set_option(Options& options, std::string_view name, std::string_view text) {
  bool found = false;
  visit_options(options, [&](auto& field, const Declaration& declaration) {
    if (name != declaration.name) return;
    found = true;
    if constexpr (std::is_enum_v<std::remove_reference_t<decltype(field)>>) {
      detail::parse(text, declaration, Choice(field));
    } else {
      detail::parse(text, declaration, field);
    }
  });
  return found;
}

/// Options of another type, with the values of those options that have the same name and type in `from`.
template <class To, class From>
To shared_options(const From& from, To to = {}) {
  visit_options(to, [&](auto& field, const Declaration& declaration) {
    visit_options(from, [&](const auto& value, const Declaration& other) {
      if constexpr (std::is_same_v<std::remove_reference_t<decltype(field)>,
                                   std::remove_cvref_t<decltype(value)>>)
        if (std::string_view(other.name) == declaration.name) field = value;
    });
  });
  return to;
}

/// The name among `names` that `name` was most likely meant to be; empty if none is near.
std::string nearest_name(std::string_view name, const std::vector<std::string>& names);

}  // namespace slalom
