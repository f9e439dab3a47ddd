#pragma once

#include <string>

#include "slalom/evaluation/json.hpp"

namespace slalom::tools {

/// Writes a result as JSON to `file`, or to standard output if it is "-". Throws IoError.
void write_json(const Json& result, const std::string& file);

}  // namespace slalom::tools
