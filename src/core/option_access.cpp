#include "slalom/core/option_access.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "slalom/core/error.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom {
namespace {

[[noreturn]] void refuse(std::string_view text, const std::string& rule) {
  std::string message = "'";
  message.append(text).append("' ").append(rule);
  throw std::invalid_argument(shortened(message));
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::string number_text(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value > 0 ? ".inf" : "-.inf";
  char buffer[32];
#if defined(__cpp_lib_to_chars)
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
#else  // libc++ 14: the fewest digits that give the value again
  for (int digits = 1; digits <= 17; ++digits) {
    std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
    if (std::strtod(buffer, nullptr) == value) break;
  }
  return buffer;
#endif
}

/// A value as people write it: 100000000, not 1e+08.
std::string shown(double value) {
  const bool whole = std::abs(value) < 1e15 && value == std::floor(value);
  return whole ? std::to_string(saturate_cast<std::int64_t>(value)) : number_text(value);
}

/// "section.option", or the option alone.
std::string full_name(std::string_view where, const Declaration& d) {
  return std::string(where) + (where.empty() ? "" : ".") + d.name;
}

/// Number of single-letter changes from one word to the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, change});
    }
  }
  return row.back();
}

void check_range(const Declaration& declaration, double value) {
  if (!(value >= declaration.min && value <= declaration.max)) refuse(shown(value), range_rule(declaration));
}

template <class Integer>
void parse_whole(std::string_view text, const Declaration& declaration, const char* rule, Integer& field) {
  Integer value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range && end == text.data() + text.size())
    refuse(text, "must be an integer from " + std::to_string(std::numeric_limits<Integer>::min()) + " to " +
                     std::to_string(std::numeric_limits<Integer>::max()));
  if (error != std::errc{} || end != text.data() + text.size()) refuse(text, rule);
  check_range(declaration, static_cast<double>(value));
  field = value;
}

double number_of(std::string_view text) {
  if (text == ".inf" || text == "inf") return std::numeric_limits<double>::infinity();
  if (text == "-.inf" || text == "-inf") return -std::numeric_limits<double>::infinity();
  const std::string_view digits = !text.empty() && text.front() == '+' ? text.substr(1) : text;
  double value = 0;
#if defined(__cpp_lib_to_chars)
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool is_number = error == std::errc{} && end == digits.data() + digits.size();
#else
  const std::string copy(digits);
  char* end = nullptr;
  value = std::strtod(copy.c_str(), &end);
  const bool is_number = copy.find_first_not_of("0123456789+-.eE") == std::string::npos && !copy.empty() &&
                         end == copy.c_str() + copy.size();
#endif
  if (!is_number || !std::isfinite(value)) refuse(text, "must be a number");
  return value;
}

std::vector<double> numbers_of(std::string_view text) {
  const std::string_view all = trimmed(text);
  if (all.empty() || all.front() != '[') return {number_of(all)};
  if (all.back() != ']') refuse(text, "must be a number or a list of numbers, [a, b]");
  std::vector<double> values;
  std::string_view rest = all.substr(1, all.size() - 2);
  while (true) {
    const auto comma = rest.find(',');
    values.push_back(number_of(trimmed(rest.substr(0, comma))));
    if (comma == std::string_view::npos) return values;
    rest.remove_prefix(comma + 1);
  }
}

}  // namespace

const char* type_name(const OptionEntry& entry) {
  constexpr const char* names[] = {"flag", "integer", "integer", "number", "numbers", "choice"};
  static_assert(std::size(names) == std::variant_size_v<OptionValue>);
  return names[entry.value.index()];
}

std::string to_text(const OptionValue& value) {
  struct Text {
    std::string operator()(bool v) const { return v ? "true" : "false"; }
    std::string operator()(int v) const { return std::to_string(v); }
    std::string operator()(std::uint64_t v) const { return std::to_string(v); }
    std::string operator()(double v) const { return number_text(v); }
    std::string operator()(const std::vector<double>& v) const {
      if (v.size() == 1) return number_text(v[0]);
      std::string text;
      for (const double each : v) text.append(text.empty() ? "[" : ", ").append(number_text(each));
      return text.append("]");
    }
    std::string operator()(const std::string& v) const { return v; }
  };
  return std::visit(Text{}, value);
}

std::string range_rule(const Declaration& d) {
  if (std::isinf(d.min) && std::isinf(d.max)) return "must be a number";
  if (std::isinf(d.max)) return "must be at least " + shown(d.min);
  if (std::isinf(d.min)) return "must be at most " + shown(d.max);
  return "must be in [" + shown(d.min) + ", " + shown(d.max) + "]";
}

namespace {

/// Names that other programs have for options.
constexpr std::pair<std::string_view, std::string_view> names_of_others[] = {
    {"K", "samples"},
    {"num_samples", "samples"},
    {"n_samples", "samples"},
    {"batch_size", "samples"},
    {"T", "horizon"},
    {"num_timesteps", "horizon"},
    {"time_steps", "horizon"},
    {"lambda", "temperature"},
    {"lambda_", "temperature"},
    {"sigma", "variance"},
    {"noise_sigma", "variance"},
    {"Sigma", "variance"},
    {"u_min", "input_min"},
    {"u_max", "input_max"},
    {"num_threads", "threads"},
    {"random_seed", "seed"},
    {"N", "samples"},
};

/// The part of a name after its last dot.
std::string_view last_part(std::string_view name) {
  return name.substr(name.rfind('.') + 1);
}

}  // namespace

std::string nearest_name(std::string_view name, const std::vector<std::string>& names) {
  for (const auto& [theirs, ours] : names_of_others)
    if (theirs == last_part(name))
      for (const std::string& candidate : names)
        if (last_part(candidate) == ours) return candidate;
  std::string best;
  std::size_t least = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const std::string& candidate : names)
    if (const std::size_t changes = edit_distance(name, candidate); changes < least) {
      least = changes;
      best = candidate;
    }
  return best;
}

namespace detail {

void throw_out_of_range(std::string_view where, const Declaration& d, double value) {
  throw std::invalid_argument(full_name(where, d) + ": " + shown(value) + " " + range_rule(d));
}

void throw_wrong_count(std::string_view where, const Declaration& d, std::size_t count, int inputs) {
  std::string rule = "one";
  if (d.any_count) {
    rule += " or more";
  } else {
    if (inputs != 1) rule += " for all inputs";
    if (inputs > 1) rule += ", or one for each of the " + std::to_string(inputs);
  }
  throw std::invalid_argument(full_name(where, d) + ": has " + std::to_string(count) + " values, must have " +
                              rule);
}

void parse(std::string_view text, const Declaration&, bool& field) {
  if (text != "true" && text != "false") refuse(text, "must be true or false");
  field = text == "true";
}

void parse(std::string_view text, const Declaration& declaration, int& field) {
  parse_whole(text, declaration, "must be an integer", field);
}

void parse(std::string_view text, const Declaration& declaration, std::uint64_t& field) {
  parse_whole(text, declaration, "must be an integer from 0 to 18446744073709551615", field);
}

void parse(std::string_view text, const Declaration& declaration, double& field) {
  const double value = number_of(text);
  check_range(declaration, value);
  field = value;
}

void parse(std::string_view text, const Declaration& declaration, PerInput& field) {
  std::vector<double> values = numbers_of(text);
  for (const double value : values) check_range(declaration, value);
  field = PerInput(std::move(values));
}

void parse(std::string_view text, const Declaration&, const Choice& field) {
  std::string all;
  for (int i = 0; field.names()[i]; ++i) {
    if (text == field.names()[i]) return field.set(i);
    all.append(i > 0 ? ", " : "").append(field.names()[i]);
  }
  refuse(text, "must be one of " + all);
}

}  // namespace detail
}  // namespace slalom
