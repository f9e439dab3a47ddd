#include "option_parameters.hpp"

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
    case ParameterType::PARAMETER_INTEGER:
      return std::to_string(value.get<std::int64_t>());
    case ParameterType::PARAMETER_DOUBLE:
      return slalom::to_text(value.get<double>());
    case ParameterType::PARAMETER_DOUBLE_ARRAY:
      return slalom::to_text(value.get<std::vector<double>>());
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

rcl_interfaces::msg::ParameterDescriptor descriptor_of(const OptionEntry& entry) {
  const std::string unit = entry.declaration.unit;
  rcl_interfaces::msg::ParameterDescriptor d;
  d.description = entry.declaration.help + (unit.empty() ? "" : " [" + unit + "]");
  d.additional_constraints = rule_of(entry);
  return d;
}

}  // namespace

OptionParameters::OptionParameters(rclcpp_lifecycle::LifecycleNode& node, List list, Change change,
                                   std::string prefix)
    : node_(node), list_(std::move(list)), change_(std::move(change)), prefix_(std::move(prefix)) {
  nodes::Changes given;
  for (const auto& [name, entry] : list_()) {
    const std::string parameter = prefix_ + name;
    names_.insert(parameter);
    if (!node_.has_parameter(parameter))
      node_.declare_parameter(parameter, value_of(entry), descriptor_of(entry));
    const ParameterValue value = node_.get_parameter(parameter).get_parameter_value();
    if (value != value_of(entry)) given.emplace_back(name, text_of(value));
  }
  check_names();
  change_(given);
  on_set_ = node_.add_on_set_parameters_callback(
      [this](const std::vector<rclcpp::Parameter>& parameters) { return set(parameters); });
}

/// Throws if the user gave a value for a name that no option of its section has.
void OptionParameters::check_names() const {
  const auto section_of = [this](const std::string& name) {
    const auto dot = name.find('.', prefix_.size());
    return name.rfind(prefix_, 0) != 0 || dot == std::string::npos ? "" : name.substr(0, dot);
  };
  std::set<std::string> sections;
  for (const std::string& name : names_) sections.insert(section_of(name));
  for (const auto& [name, value] : node_.get_node_parameters_interface()->get_parameter_overrides()) {
    const std::string section = section_of(name);
    if (section.empty() || sections.count(section) == 0) continue;
    if (names_.count(name) == 0) throw std::invalid_argument("parameter " + name + ": unknown option");
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
    if (names_.count(parameter.get_name()) > 0)
      changes.emplace_back(parameter.get_name().substr(prefix_.size()),
                           text_of(parameter.get_parameter_value()));
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
