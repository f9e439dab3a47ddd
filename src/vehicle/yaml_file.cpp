#include "vehicle/yaml_file.hpp"

#include "slalom/core/error.hpp"

namespace slalom::vehicle::detail {

YAML::Node load_yaml(const std::filesystem::path& file) {
  try {
    return YAML::LoadFile(file.string());
  } catch (const YAML::BadFile&) {
    throw IoError(file.string(), 0, "cannot be opened");
  } catch (const YAML::Exception& error) {
    throw IoError(file.string(), error.mark.line + 1, "is not YAML: " + error.msg);
  }
}

void refuse(const std::filesystem::path& file, const YAML::Node& at, const std::string& key,
            const std::string& rule) {
  const std::string value = at.IsScalar() && !at.Scalar().empty() ? "'" + at.Scalar() + "' " : "";
  throw IoError(file.string(), at.Mark().line + 1, "key " + key + ": " + value + rule);
}

}  // namespace slalom::vehicle::detail
