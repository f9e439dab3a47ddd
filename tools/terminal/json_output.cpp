#include "tools/terminal/json_output.hpp"

#include <fstream>
#include <iostream>

#include "slalom/core/error.hpp"
#include "src/evaluation/json.hpp"

namespace slalom::tools {

void write_json(const Json& result, const std::string& file) {
  const std::string text = json_text(result, 2) + "\n";
  if (file == "-") {
    std::cout << text << std::flush;
    return;
  }
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw IoError(file, 0, "cannot be written");
}

}  // namespace slalom::tools
