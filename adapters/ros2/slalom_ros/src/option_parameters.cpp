#include "option_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>

#include <rclcpp/version.h>

namespace slalom_ros {
namespace {

using rclcpp::ParameterType;
using rclcpp::ParameterValue;
using slalom_bridge::Option;

double number_of(const std::string& text) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return text == ".inf" ? infinity : text == "-.inf" ? -infinity : std::strtod(text.c_str(), nullptr);
}

/// Of "0.1" or "[0.1, 0.2]".
std::vector<double> numbers_of(std::string text) {
  for (char& c : text)
    if (c == '[' || c == ']' || c == ',') c = ' ';
  std::vector<double> numbers;
  std::istringstream words(text);
  for (std::string word; words >> word;) numbers.push_back(number_of(word));
  return numbers;
}

ParameterValue value_of(const Option& o) {
  if (o.type == "flag") return ParameterValue(o.value == "true");
  if (o.type == "integer") return ParameterValue(std::int64_t{std::strtoll(o.value.c_str(), nullptr, 10)});
  if (o.type == "number") return ParameterValue(number_of(o.value));
  if (o.type == "numbers") return ParameterValue(numbers_of(o.value));
  return ParameterValue(o.value);
}

std::string text_of(double value) {
  if (std::isinf(value)) return value > 0 ? ".inf" : "-.inf";
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  text << value;
  return text.str();
}

std::string text_of(const ParameterValue& value) {
  switch (value.get_type()) {
    case ParameterType::PARAMETER_BOOL:
      return value.get<bool>() ? "true" : "false";
    case ParameterType::PARAMETER_INTEGER:
      return std::to_string(value.get<std::int64_t>());
    case ParameterType::PARAMETER_DOUBLE:
      return text_of(value.get<double>());
    case ParameterType::PARAMETER_DOUBLE_ARRAY: {
      std::string text;
      for (const double entry : value.get<std::vector<double>>())
        text += (text.empty() ? "" : ", ") + text_of(entry);
      return "[" + text + "]";
    }
    case ParameterType::PARAMETER_STRING:
      return value.get<std::string>();
    default:
      return rclcpp::to_string(value);
  }
}

std::int64_t whole(double value) {
  constexpr double most = 9.2e18;  // less than the largest std::int64_t
  return static_cast<std::int64_t>(std::clamp(value, -most, most));
}

rcl_interfaces::msg::ParameterDescriptor descriptor_of(const Option& o) {
  rcl_interfaces::msg::ParameterDescriptor d;
  d.description = o.help + (o.unit.empty() ? "" : " [" + o.unit + "]");
  d.additional_constraints = o.rule;
  if (o.type == "choice") {
    d.additional_constraints = "must be one of";
    for (const std::string& choice : o.choices) d.additional_constraints += " " + choice;
  }
  if (std::isinf(o.min) && std::isinf(o.max)) return d;
  if (o.type == "number") {
    d.floating_point_range.resize(1);
    d.floating_point_range[0].from_value = o.min;
    d.floating_point_range[0].to_value = o.max;
  } else if (o.type == "integer") {
    d.integer_range.resize(1);
    d.integer_range[0].from_value = whole(o.min);
    d.integer_range[0].to_value = whole(o.max);
  }
  return d;
}

}  // namespace

OptionParameters::OptionParameters(rclcpp_lifecycle::LifecycleNode& node, List list, Change change,
                                   std::string prefix)
    : node_(node), list_(std::move(list)), change_(std::move(change)), prefix_(std::move(prefix)) {
  slalom_bridge::Changes given;
  for (const Option& option : list_()) {
    declare(option);
    const ParameterValue value = node_.get_parameter(parameter_name(option.name)).get_parameter_value();
    if (value != value_of(option)) given.emplace_back(option.name, text_of(value));
  }
  check_names();
  change_(given);
  on_set_ = node_.add_on_set_parameters_callback(
      [this](const std::vector<rclcpp::Parameter>& parameters) { return set(parameters); });
#if RCLCPP_VERSION_GTE(21, 0, 0)
  before_set_ = node_.add_pre_set_parameters_callback(
      [this](std::vector<rclcpp::Parameter>& parameters) { log_broken_ranges(parameters); });
#endif
}

std::string OptionParameters::parameter_name(std::string option) const {
  std::replace(option.begin(), option.end(), '/', '.');
  return prefix_ + option;
}

void OptionParameters::declare(const Option& option) {
  const std::string name = parameter_name(option.name);
  options_.emplace(name, option);
  if (node_.has_parameter(name)) return;
  try {
    node_.declare_parameter(name, value_of(option), descriptor_of(option));
  } catch (const std::exception& error) {
    throw std::invalid_argument(name + " " + option.rule + ": " + error.what());
  }
}

/// Values that the user gave for no option of their section.
void OptionParameters::check_names() const {
  const auto section_of = [this](const std::string& name) {
    const auto dot = name.find('.', prefix_.size());
    return name.rfind(prefix_, 0) != 0 || dot == std::string::npos ? "" : name.substr(0, dot);
  };
  std::set<std::string> sections;
  for (const auto& [name, option] : options_) sections.insert(section_of(name));
  for (const auto& [name, value] : node_.get_node_parameters_interface()->get_parameter_overrides()) {
    const std::string section = section_of(name);
    if (section.empty() || sections.count(section) == 0) continue;
    if (options_.count(name) == 0) throw std::invalid_argument("parameter " + name + ": unknown option");
  }
}

std::vector<std::string> OptionParameters::unused() const {
  std::vector<std::string> names;
  for (const auto& [name, value] : node_.get_node_parameters_interface()->get_parameter_overrides())
    if (name.rfind(prefix_, 0) == 0 && !node_.has_parameter(name)) names.push_back(name);
  return names;
}

rcl_interfaces::msg::SetParametersResult OptionParameters::set(
    const std::vector<rclcpp::Parameter>& parameters) {
  rcl_interfaces::msg::SetParametersResult result;
  result.successful = true;
  if (refreshing_) return result;
  slalom_bridge::Changes changes;
  for (const rclcpp::Parameter& parameter : parameters)
    if (const auto found = options_.find(parameter.get_name()); found != options_.end())
      changes.emplace_back(found->second.name, text_of(parameter.get_parameter_value()));
  if (changes.empty()) return result;
  try {
    change_(changes);
    for (const auto& [name, text] : changes)
      RCLCPP_INFO(node_.get_logger(), "set %s to %s", parameter_name(name).c_str(), text.c_str());
  } catch (const std::exception& error) {
    result.successful = false;
    result.reason = error.what();
    RCLCPP_ERROR(node_.get_logger(), "not changed: %s", error.what());
  }
  return result;
}

void OptionParameters::log_broken_ranges(const std::vector<rclcpp::Parameter>& parameters) const {
  for (const rclcpp::Parameter& parameter : parameters) {
    const auto found = options_.find(parameter.get_name());
    if (found == options_.end()) continue;
    const ParameterType type = parameter.get_type();
    if (type != ParameterType::PARAMETER_DOUBLE && type != ParameterType::PARAMETER_INTEGER) continue;
    const double value = type == ParameterType::PARAMETER_DOUBLE ? parameter.as_double()
                                                                 : static_cast<double>(parameter.as_int());
    if (value < found->second.min || value > found->second.max)
      RCLCPP_ERROR(node_.get_logger(), "not changed: %s: '%s' %s", found->first.c_str(),
                   parameter.value_to_string().c_str(), found->second.rule.c_str());
  }
}

void OptionParameters::refresh() {
  std::vector<rclcpp::Parameter> differing;
  for (const Option& option : list_()) {
    const std::string name = parameter_name(option.name);
    const ParameterValue value = value_of(option);
    if (node_.get_parameter(name).get_parameter_value() != value) differing.emplace_back(name, value);
  }
  if (differing.empty()) return;
  refreshing_ = true;
  node_.set_parameters(differing);
  refreshing_ = false;
}

}  // namespace slalom_ros
