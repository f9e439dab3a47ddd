#pragma once

#include <functional>
#include <memory>
#include <set>

#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "logic/named_option.hpp"

namespace slalom_ros {

namespace nodes = slalom::nodes;

/// The descriptor of a parameter that is fixed once it is declared.
inline rcl_interfaces::msg::ParameterDescriptor fixed(const std::string& description) {
  rcl_interfaces::msg::ParameterDescriptor descriptor;
  descriptor.description = description;
  descriptor.read_only = true;
  return descriptor;
}

/// Declared options of Slalom as parameters of a node, with type, description and rule, that can change while
/// the node runs. A change that breaks a rule is refused with that rule.
class OptionParameters {
 public:
  using List = std::function<std::vector<nodes::NamedOption>()>;
  using Change = std::function<void(const nodes::Changes&)>;  ///< throws std::exception

  /// Declares the options, with the values of `list` where the user gave none, and applies those of the user.
  /// The names of all parameters begin with `prefix`. Throws std::exception if one of them breaks a rule or a
  /// section has no option of its name. The node must outlive this.
  OptionParameters(rclcpp_lifecycle::LifecycleNode& node, List list, Change change, std::string prefix = "");

  /// The names under the prefix for which the user gave a value and nobody has declared a parameter.
  std::vector<std::string> unused() const;

  /// Sets the parameters to the options that something else changed.
  void refresh();

 private:
  void check_names() const;
  rcl_interfaces::msg::SetParametersResult set(const std::vector<rclcpp::Parameter>& parameters);

  rclcpp_lifecycle::LifecycleNode& node_;
  List list_;
  Change change_;
  std::string prefix_;
  std::set<std::string> names_;  ///< names of the parameters
  bool refreshing_ = false;
  std::shared_ptr<void> on_set_;  ///< the registration of `set`
};

}  // namespace slalom_ros
