#pragma once

#include <iostream>

#include "json/json.hpp"
#include "slalom/core/files/write_file.hpp"

namespace slalom::tools {

/// Writes a result as JSON to `file`, or to standard output if it is "-". Throws IoError.
inline void write_json(const Json& result, const std::string& file) {
  const std::string text = json_text(result, 2) + "\n";
  if (file == "-")
    std::cout << text << std::flush;
  else
    write_file(file, text);
}

}  // namespace slalom::tools
