#include "vehicle/course/course_readers.hpp"

#include "slalom/core/error.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "slalom/maps/yaml_text.hpp"
#include "vehicle/yaml_file.hpp"

namespace slalom::vehicle {
namespace detail {
namespace {

/// One value of a file, with its position for messages.
class Value {
 public:
  Value(const std::filesystem::path& file, std::string key, const YAML::Node& node)
      : file_(file), key_(std::move(key)), node_(node) {}

  [[noreturn]] void reject(const std::string& rule) const { detail::throw_at(file_, node_, key_, rule); }

  double number() const {
    const auto value = node_.IsScalar() ? maps::finite_number(node_.Scalar()) : std::nullopt;
    if (!value) reject("must be a finite number");
    return *value;
  }

  double positive() const {
    const double value = number();
    if (!(value > 0)) reject("must be above 0");
    return value;
  }

  std::string text() const {
    if (!node_.IsScalar()) reject("must be a string");
    return node_.Scalar();
  }

  bool flag() const {
    bool value = false;
    if (!node_.IsScalar() || !YAML::convert<bool>::decode(node_, value)) reject("must be true or false");
    return value;
  }

  maps::Pose pose() const {
    if (!node_.IsMap()) reject("must be {x, y, yaw} in m, m, rad");
    for (const auto& entry : node_) {
      const std::string name = entry.first.Scalar();
      if (name != "x" && name != "y" && name != "yaw")
        Value(file_, key_ + "." + name, entry.first).reject("unknown key; must be x, y or yaw");
    }
    const maps::Pose pose{member("x").number(), member("y").number(), member("yaw").number()};
    if (!maps::is_plausible(pose)) reject(maps::PoseLimits::rule);
    return pose;
  }

  Value member(const std::string& name) const {
    const YAML::Node child = node_[name];
    if (!child) throw IoError(file_.string(), line(), "key " + key_ + "." + name + ": missing");
    return {file_, key_ + "." + name, child};
  }

  int line() const { return node_.Mark().line + 1; }

 private:
  std::filesystem::path file_;
  std::string key_;
  YAML::Node node_;
};

}  // namespace

CourseFile read_course_file(const std::filesystem::path& file) {
  const YAML::Node root = load_yaml(file);
  CourseFile result;
  if (root.IsNull()) return result;
  if (!root.IsMap()) throw IoError(file.string(), root.Mark().line + 1, "must be a map of keys to values");
  for (const auto& entry : root) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
    // yaml-cpp gives an absent value the position of the next token.
    if (entry.second.IsNull())
      throw IoError(file.string(), entry.first.Mark().line + 1, "key " + key + ": must have a value");
    const Value value(file, key, entry.second);
    if (key == "name") {
      result.name = value.text();
    } else if (key == "description") {
      result.description = value.text();
    } else if (key == "command") {
      value.text();
    } else if (key == "start") {
      result.start = value.pose();
      result.start_line = value.line();
    } else if (key == "timeout") {
      result.timeout = value.positive();
    } else if (key == "closed") {
      result.closed = value.flag();
    } else {
      throw IoError(
          file.string(), entry.first.Mark().line + 1,
          "key " + key + ": unknown key; must be one of name, description, command, start, timeout, closed");
    }
  }
  return result;
}

bool may_be_map(const std::filesystem::path& file) {
  try {
    const YAML::Node root = load_yaml(file);
    return !root.IsMap() || root["image"];
  } catch (const IoError&) {
    return true;
  }
}

}  // namespace detail

std::optional<KnownCourse> known_course(const std::string& name,
                                        const std::vector<std::filesystem::path>& roots) {
  for (const auto& folder : roots) {
    const std::filesystem::path file = folder / "known.yaml";
    if (!std::filesystem::exists(file)) continue;
    const YAML::Node root = detail::load_yaml(file);
    if (!root.IsMap()) throw IoError(file.string(), 0, "must be a map of course names to {start, timeout}");
    const YAML::Node node = root[name];
    if (!node) return std::nullopt;
    const detail::Value entry(file, name, node);
    if (!node.IsMap()) entry.reject("must be {start, timeout}");
    return KnownCourse{entry.member("start").pose(), entry.member("timeout").positive()};
  }
  return std::nullopt;
}

}  // namespace slalom::vehicle
