#include <yaml-cpp/yaml.h>

#include "slalom/core/error.hpp"
#include "slalom/maps/yaml_text.hpp"
#include "slalom/vehicle/racing/racing_car.hpp"
#include "vehicle/yaml_file.hpp"

namespace slalom::vehicle {
namespace {

namespace fs = std::filesystem;

/// The number of a key, which only means something where it is above 0, or at least 0 with `zero`.
double number(const fs::path& file, const std::string& key, const YAML::Node& node, bool zero = false) {
  const auto value = node.IsScalar() ? maps::finite_number(node.Scalar()) : std::nullopt;
  if (!value || *value < 0 || (*value == 0 && !zero))
    detail::throw_at(file, node, key, zero ? "must be a number of at least 0" : "must be a number above 0");
  return *value;
}

std::vector<GripAtSpeed> read_grip(const fs::path& file, const YAML::Node& rows) {
  const char* const rule =
      "must be a list of rows [speed, acceleration, braking, lateral acceleration], by rising speed";
  if (!rows.IsSequence() || rows.size() == 0) detail::throw_at(file, rows, "ggv", rule);
  std::vector<GripAtSpeed> grip;
  for (const YAML::Node& row : rows) {
    if (!row.IsSequence() || row.size() != 4) detail::throw_at(file, row, "ggv", rule);
    const GripAtSpeed read{number(file, "ggv", row[0], true), number(file, "ggv", row[1]),
                           number(file, "ggv", row[2]), number(file, "ggv", row[3])};
    if (!grip.empty() && !(read.speed > grip.back().speed)) detail::throw_at(file, row, "ggv", rule);
    grip.push_back(read);
  }
  return grip;
}

}  // namespace

RacingCar load_racing_car(const fs::path& file) {
  const YAML::Node root = detail::load_yaml(file);
  if (!root.IsMap()) throw IoError(file.string(), root.Mark().line + 1, "must be a map of keys to values");
  RacingCar car;
  if (const YAML::Node base = root["base"]) try {
      car = racing_car(base.IsScalar() ? base.Scalar() : "");
    } catch (const std::invalid_argument& error) {
      throw IoError(file.string(), base.Mark().line + 1, std::string("key base: ") + error.what());
    }
  car.name = file.stem().string();
  const auto keys = numbers_of(car);
  for (const auto& entry : root) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
    if (key == "base") continue;
    if (key == "ggv") {
      car.grip = read_grip(file, entry.second);
      continue;
    }
    double* value = nullptr;
    std::string known = "base, ggv";
    for (const auto& [name, field] : keys) {
      known += std::string(", ") + name;
      if (key == name) value = field;
    }
    if (!value)
      throw IoError(file.string(), entry.first.Mark().line + 1,
                    "key " + key + ": unknown key; must be one of " + known);
    *value = number(file, key, entry.second, key == "margin");
  }
  try {
    validate(car);
  } catch (const std::invalid_argument& error) {
    throw IoError(file.string(), 0, std::string("key ") + error.what());
  }
  return car;
}

RacingCar find_racing_car(const std::string& name_or_file) {
  return fs::is_regular_file(name_or_file) ? load_racing_car(name_or_file) : racing_car(name_or_file);
}

}  // namespace slalom::vehicle
