#include "tools/terminal/json_output.hpp"

#include <iostream>

#include "json/json.hpp"
#include "slalom/core/files/write_file.hpp"

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
