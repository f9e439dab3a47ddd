#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>

#include "slalom/core/option_access.hpp"

/// Options as keyword arguments: names, defaults, ranges and errors are those of the C++ declarations.
namespace slalom::python {

namespace py = pybind11;

template <class Field>
const char* type_words(const Field&) {
  if constexpr (std::is_same_v<Field, bool>) {
    return "True or False";
  } else if constexpr (std::is_enum_v<Field> || std::is_same_v<Field, Choice>) {
    return "one of its choices";
  } else if constexpr (std::is_same_v<Field, PerInput>) {
    return "a number, or one for each input";
  } else if constexpr (std::is_same_v<Field, double>) {
    return "a number";
  } else {
    return "a whole number";
  }
}

/// Sets a field from a Python value. Throws TypeError for values of another type, ValueError for an
/// unknown choice.
template <class Field>
void set_field(Field& field, const std::string& name, py::handle value) {
  try {
    if constexpr (std::is_same_v<Field, bool>) {
      if (!py::isinstance<py::bool_>(value)) throw py::cast_error();
      field = value.cast<bool>();
    } else if constexpr (std::is_enum_v<Field>) {
      Choice choice(field);
      choice.set(detail::parse_choice(value.cast<std::string>(), choice.names()));
    } else if constexpr (std::is_same_v<Field, Choice>) {
      field.set(detail::parse_choice(value.cast<std::string>(), field.names()));
    } else if constexpr (std::is_same_v<Field, PerInput>) {
      if (py::isinstance<py::float_>(value) || py::isinstance<py::int_>(value)) {
        field = PerInput(value.cast<double>());
      } else {
        field = PerInput(value.cast<std::vector<double>>());
      }
    } else {
      field = value.cast<Field>();
    }
  } catch (const std::invalid_argument& error) {
    throw py::value_error(name + ": " + error.what());
  } catch (const py::cast_error&) {
    throw py::type_error(name + ": " + py::repr(value).cast<std::string>() + " must be " + type_words(field));
  }
}

/// Sets the options that are given. `where` precedes their names in errors.
template <class Options>
void set_from_keywords(Options& options, const py::kwargs& keywords, const std::string& where) {
  for (const auto& keyword : keywords) {
    const std::string name = keyword.first.template cast<std::string>();
    const py::handle value = keyword.second;
    std::vector<std::string> names;
    bool found = false;
    visit_options(options, [&](auto& field, const Declaration& declaration) {
      names.emplace_back(declaration.name);
      if (name != declaration.name) return;
      found = true;
      set_field(field, where + "." + name, value);
    });
    if (found) continue;
    const std::string nearest = nearest_name(name, names);
    throw py::type_error(where + ": unknown option '" + name + "'" +
                         (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
}

inline py::object to_python(const OptionValue& value) {
  return std::visit(
      [](const auto& v) -> py::object {
        if constexpr (std::is_same_v<std::decay_t<decltype(v)>, std::vector<double>>) {
          if (v.size() == 1) return py::cast(v[0]);
        }
        return py::cast(v);
      },
      value);
}

/// The options as a list of dictionaries.
template <class Options>
py::list describe_options(const Options& options) {
  py::list all;
  for (const OptionEntry& entry : list_options(options)) {
    const Declaration& d = entry.declaration;
    py::dict one;
    one["name"] = d.name;
    one["type"] = type_name(entry);
    one["default"] = to_python(entry.value);
    one["symbol"] = d.symbol;
    one["unit"] = d.unit;
    one["min"] = d.min;
    one["max"] = d.max;
    one["choices"] = entry.choices;
    one["help"] = d.help;
    all.append(one);
  }
  return all;
}

/// A line for every option, for docstrings.
template <class Options>
std::string options_text(const Options& options) {
  std::string text;
  for (const OptionEntry& entry : list_options(options)) {
    const Declaration& d = entry.declaration;
    text += "    " + std::string(d.name) + " = " + to_text(entry.value);
    if (*d.unit) text += " [" + std::string(d.unit) + "]";
    text += ": " + std::string(d.help);
    for (std::size_t i = 0; i < entry.choices.size(); ++i) {
      text += (i ? ", " : "; one of ") + entry.choices[i];
    }
    text += "\n";
  }
  return text;
}

}  // namespace slalom::python
