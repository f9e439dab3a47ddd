#include "tools/terminal/json_output.hpp"

#include <iostream>

#include "slalom/core/files/write_file.hpp"
#include "src/evaluation/json.hpp"

namespace slalom::tools {

void write_json(const Json& result, const std::string& file) {
  const std::string text = json_text(result, 2) + "\n";
  if (file == "-") {
    std::cout << text << std::flush;
    return;
  }
  write_file(file, text);
}

}  // namespace slalom::tools
