#pragma once

#include <algorithm>
#include <functional>
#include <set>
#include <sstream>

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/ros.h>

#include "bridge/bridge.hpp"

/// Declared options as ROS parameters that can change while the node runs. The messages of
/// dynamic_reconfigure are made from the declarations, so that rqt_reconfigure and `dynparam` know every
/// option.
namespace slalom_ros1 {

inline std::string text_of(XmlRpc::XmlRpcValue value) {
  std::ostringstream text;
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeString:
      return static_cast<std::string>(value);
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return static_cast<bool>(value) ? "true" : "false";
    case XmlRpc::XmlRpcValue::TypeInt:
      text << static_cast<int>(value);
      break;
    case XmlRpc::XmlRpcValue::TypeDouble:
      text.precision(17);
      text << static_cast<double>(value);
      break;
    case XmlRpc::XmlRpcValue::TypeArray:
      text << '[';
      for (int i = 0; i < value.size(); ++i) text << (i ? ", " : "") << text_of(value[i]);
      text << ']';
      break;
    default:
      text << "?";
      break;
  }
  return text.str();
}

/// The options that the parameter server has in the namespace of the node. An unknown name in a section is an
/// error.
inline slalom_bridge::Changes parameters_set(ros::NodeHandle& own,
                                             const std::vector<slalom_bridge::Option>& options) {
  slalom_bridge::Changes changes;
  std::set<std::string> sections;
  for (const auto& option : options) {
    const auto slash = option.name.find('/');
    XmlRpc::XmlRpcValue value;
    if (slash != std::string::npos)
      sections.insert(option.name.substr(0, slash));
    else if (own.getParam(option.name, value))
      changes.emplace_back(option.name, text_of(value));
  }
  for (const std::string& section : sections) {
    XmlRpc::XmlRpcValue values;
    if (!own.getParam(section, values) || values.getType() != XmlRpc::XmlRpcValue::TypeStruct) continue;
    for (auto& [name, value] : values) changes.emplace_back(section + "/" + name, text_of(value));
  }
  return changes;
}

class DynamicParameters {
 public:
  using List = std::function<std::vector<slalom_bridge::Option>()>;
  using Change = std::function<void(const slalom_bridge::Changes&)>;  ///< throws std::exception with a
                                                                      ///< message for the user

  DynamicParameters(ros::NodeHandle& own, List list, Change change)
      : own_(own), list_(std::move(list)), change_(std::move(change)) {
    descriptions_ = own.advertise<dynamic_reconfigure::ConfigDescription>("parameter_descriptions", 1, true);
    updates_ = own.advertise<dynamic_reconfigure::Config>("parameter_updates", 1, true);
    service_ = own.advertiseService("set_parameters", &DynamicParameters::set, this);
    descriptions_.publish(describe());
    updates_.publish(values());
  }

 private:
  static std::string kind(const slalom_bridge::Option& o) {
    if (o.type == "flag") return "bool";
    if (o.type == "integer") return "int";
    return o.type == "number" ? "double" : "str";
  }

  dynamic_reconfigure::GroupState state() const {
    dynamic_reconfigure::GroupState s;
    s.name = "Default";
    s.state = true;
    return s;
  }

  /// `pick` returns the value of an option as text.
  template <class Pick>
  dynamic_reconfigure::Config config(Pick&& pick) const {
    dynamic_reconfigure::Config c;
    for (const auto& o : list_()) add(c, o, pick(o));
    c.groups.push_back(state());
    return c;
  }
  dynamic_reconfigure::Config values() const {
    return config([](const slalom_bridge::Option& o) { return o.value; });
  }

  static void add(dynamic_reconfigure::Config& c, const slalom_bridge::Option& o, const std::string& text) {
    const std::string type = kind(o);
    if (type == "bool") {
      c.bools.emplace_back();
      c.bools.back().name = o.name;
      c.bools.back().value = text == "true";
    } else if (type == "int") {
      c.ints.emplace_back();
      c.ints.back().name = o.name;
      c.ints.back().value =
          static_cast<int>(std::clamp(std::atof(text.c_str()), -2147483648.0, 2147483647.0));
    } else if (type == "double") {
      c.doubles.emplace_back();
      c.doubles.back().name = o.name;
      c.doubles.back().value = text == ".inf"    ? INFINITY
                               : text == "-.inf" ? -INFINITY
                                                 : std::atof(text.c_str());
    } else {
      c.strs.emplace_back();
      c.strs.back().name = o.name;
      c.strs.back().value = text;
    }
  }

  dynamic_reconfigure::ConfigDescription describe() const {
    dynamic_reconfigure::ConfigDescription d;
    dynamic_reconfigure::Group group;
    group.name = "Default";
    for (const auto& o : list_()) {
      dynamic_reconfigure::ParamDescription p;
      p.name = o.name;
      p.type = kind(o);
      p.description = o.help + (o.unit.empty() ? "" : " [" + o.unit + "]");
      for (std::size_t i = 0; i < o.choices.size(); ++i) p.description += (i ? ", " : ": ") + o.choices[i];
      group.parameters.push_back(p);
    }
    d.groups.push_back(group);
    const auto limit = [](double value) { return std::to_string(std::clamp(value, -1e9, 1e9)); };
    d.min = config([&](const auto& o) {
      return kind(o) == "str" ? "" : kind(o) == "bool" ? "false" : limit(o.min);
    });
    d.max = config([&](const auto& o) {
      return kind(o) == "str" ? "" : kind(o) == "bool" ? "true" : limit(o.max);
    });
    d.dflt = values();
    return d;
  }

  bool set(dynamic_reconfigure::Reconfigure::Request& request,
           dynamic_reconfigure::Reconfigure::Response& response) {
    slalom_bridge::Changes changes;
    const auto number = [](double value) {
      std::ostringstream text;
      text.precision(17);
      text << value;
      return text.str();
    };
    for (const auto& p : request.config.bools) changes.emplace_back(p.name, p.value ? "true" : "false");
    for (const auto& p : request.config.ints) changes.emplace_back(p.name, std::to_string(p.value));
    for (const auto& p : request.config.doubles) changes.emplace_back(p.name, number(p.value));
    for (const auto& p : request.config.strs) changes.emplace_back(p.name, p.value);
    try {
      change_(changes);
      for (const auto& [name, text] : changes) ROS_INFO_STREAM("set " << name << " to " << text);
    } catch (const std::exception& error) {
      ROS_ERROR_STREAM("not changed: " << error.what());
    }
    response.config = values();
    updates_.publish(response.config);
    return true;
  }

  ros::NodeHandle own_;
  List list_;
  Change change_;
  ros::Publisher descriptions_, updates_;
  ros::ServiceServer service_;
};

}  // namespace slalom_ros1
