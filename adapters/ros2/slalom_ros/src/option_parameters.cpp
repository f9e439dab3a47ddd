#include "option_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <type_traits>
#include <variant>

#include <rclcpp/version.h>

namespace slalom_ros {
namespace {

using nodes::NamedOption;
using rclcpp::ParameterType;
using rclcpp::ParameterValue;
using slalom::OptionEntry;

ParameterValue value_of(const OptionEntry& entry) {
  return std::visit(
      [](const auto& value) {
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>)
          return ParameterValue(static_cast<std::int64_t>(value));
        else
          return ParameterValue(value);
      },
      entry.value);
}

std::string text_of(const ParameterValue& value) {
  switch (value.get_type()) {
    case ParameterType::PARAMETER_BOOL:
      return slalom::to_text(value.get<bool>());
    case ParameterType::PARAMETER_INTEGER:
      return std::to_string(value.get<std::int64_t>());
    case ParameterType::PARAMETER_DOUBLE:
      return slalom::to_text(value.get<double>());
    case ParameterType::PARAMETER_DOUBLE_ARRAY:
      return slalom::to_text(value.get<std::vector<double>>());
    case ParameterType::PARAMETER_STRING:
      return value.get<std::string>();
    default:
      return rclcpp::to_string(value);
  }
}

/// The rule that the values of an option keep; empty for flags.
std::string rule_of(const OptionEntry& entry) {
  if (std::holds_alternative<bool>(entry.value)) return "";
  if (entry.choices.empty()) return slalom::range_rule(entry.declaration);
  std::string rule = "must be one of";
  for (const std::string& choice : entry.choices) rule += " " + choice;
  return rule;
}

std::int64_t whole(double value) {
  constexpr double most = 9.2e18;  // less than the largest std::int64_t
  return static_cast<std::int64_t>(std::clamp(value, -most, most));
}

rcl_interfaces::msg::ParameterDescriptor descriptor_of(const OptionEntry& entry) {
  const slalom::Declaration& declared = entry.declaration;
  const std::string unit = declared.unit;
  rcl_interfaces::msg::ParameterDescriptor d;
  d.description = declared.help + (unit.empty() ? "" : " [" + unit + "]");
  d.additional_constraints = rule_of(entry);
  if (std::isinf(declared.min) && std::isinf(declared.max)) return d;
  const std::string type = slalom::type_name(entry);
  if (type == "number") {
    d.floating_point_range.resize(1);
    d.floating_point_range[0].from_value = declared.min;
    d.floating_point_range[0].to_value = declared.max;
  } else if (type == "integer") {
    d.integer_range.resize(1);
    d.integer_range[0].from_value = whole(declared.min);
    d.integer_range[0].to_value = whole(declared.max);
  }
  return d;
}

}  // namespace

OptionParameters::OptionParameters(rclcpp_lifecycle::LifecycleNode& node, List list, Change change,
                                   std::string prefix)
    : node_(node), list_(std::move(list)), change_(std::move(change)), prefix_(std::move(prefix)) {
  nodes::Changes given;
  for (const NamedOption& option : list_()) {
    declare(option);
    const ParameterValue value = node_.get_parameter(prefix_ + option.name).get_parameter_value();
    if (value != value_of(option.entry)) given.emplace_back(option.name, text_of(value));
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

void OptionParameters::declare(const NamedOption& option) {
  const std::string name = prefix_ + option.name;
  options_.emplace(name, option);
  if (node_.has_parameter(name)) return;
  try {
    node_.declare_parameter(name, value_of(option.entry), descriptor_of(option.entry));
  } catch (const std::exception& error) {
    throw std::invalid_argument(name + " " + rule_of(option.entry) + ": " + error.what());
  }
}

/// Throws if the user gave a value for a name that no option of its section has.
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
  nodes::Changes changes;
  for (const rclcpp::Parameter& parameter : parameters)
    if (const auto found = options_.find(parameter.get_name()); found != options_.end())
      changes.emplace_back(found->second.name, text_of(parameter.get_parameter_value()));
  if (changes.empty()) return result;
  try {
    change_(changes);
    for (const auto& [name, text] : changes)
      RCLCPP_INFO(node_.get_logger(), "set %s%s to %s", prefix_.c_str(), name.c_str(), text.c_str());
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
    const OptionEntry& entry = found->second.entry;
    if (value < entry.declaration.min || value > entry.declaration.max)
      RCLCPP_ERROR(node_.get_logger(), "not changed: %s: '%s' %s", found->first.c_str(),
                   parameter.value_to_string().c_str(), rule_of(entry).c_str());
  }
}

void OptionParameters::refresh() {
  std::vector<rclcpp::Parameter> differing;
  for (const NamedOption& option : list_()) {
    const std::string name = prefix_ + option.name;
    const ParameterValue value = value_of(option.entry);
    if (node_.get_parameter(name).get_parameter_value() != value) differing.emplace_back(name, value);
  }
  if (differing.empty()) return;
  refreshing_ = true;
  node_.set_parameters(differing);
  refreshing_ = false;
}

}  // namespace slalom_ros
