#pragma once

#include <concepts>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

/// JSON of nlohmann, for evaluation, program and live view. Public headers include neither it nor this file.
namespace slalom {

/// JSON whose objects keep the order in which their members were inserted.
using Json = nlohmann::ordered_json;

constexpr std::uint64_t max_json_bytes = 1ULL << 24;  ///< the largest JSON file that is read

/// Parses a text. Throws std::invalid_argument, which names line and column, if it is not JSON or nests
/// deeper than 64 levels.
inline Json parse_json(std::string_view text) {
  const auto limit_depth = [](int depth, Json::parse_event_t, const Json&) {
    return depth <= 64 ? true : throw std::invalid_argument("must not nest deeper than 64 levels");
  };
  try {
    return Json::parse(text, limit_depth);
  } catch (const Json::exception& error) {
    const std::string message =
        error.what();  // "[json.exception.parse_error.101] parse error at line 1, ..."
    throw std::invalid_argument("is not JSON: " + message.substr(message.find(' ') + 1));
  }
}

/// The parsed text, or null if it is not JSON or nests too deep.
inline Json parse_json_or_null(std::string_view text) {
  try {
    return parse_json(text);
  } catch (const std::invalid_argument&) {
    return {};
  }
}

/// The text in one line, or with `indent` spaces per level. Bytes that are not UTF-8 become U+FFFD, numbers
/// that are not finite null.
inline std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

/// The figures that `visit_figures` declares, each under its name.
template <class Figures>
Json figures_json(const Figures& figures) {
  Json json = Json::object();
  visit_figures(figures, [&](const auto& value, const auto& figure) { json[figure.name] = value; });
  return json;
}

/// The member of an object. Throws std::invalid_argument, which names the key, if there is none.
inline const Json& member(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) throw std::invalid_argument("key '" + std::string(key) + "' is missing");
  return *found;
}

/// The member of an object as a string or number. Throws std::invalid_argument, which names the key, if it is
/// missing, has another type, or is no whole number in the range of T where T is an integer.
template <class T>
T member(const Json& object, const char* key) {
  const Json& value = member(object, key);
  const auto require = [&](bool valid, const char* rule) {
    if (!valid) throw std::invalid_argument("key '" + std::string(key) + "': " + json_text(value) + rule);
  };
  if constexpr (std::integral<T>) {
    using Limits = std::numeric_limits<T>;
    require(value.is_number_integer() && value.get<double>() >= static_cast<double>(Limits::min()) &&
                value.get<double>() <= static_cast<double>(Limits::max()),
            " must be a whole number that is not too large");
  } else if constexpr (std::floating_point<T>) {
    require(value.is_number(), " must be a number");
  } else {
    require(value.is_string(), " must be a string");
  }
  return value.get<T>();
}

}  // namespace slalom
