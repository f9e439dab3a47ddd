#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace slalom::tools {

/// Writes a result as JSON to `file`, or to standard output if it is "-". Throws IoError.
void write_json(const nlohmann::ordered_json& result, const std::string& file);

}  // namespace slalom::tools
