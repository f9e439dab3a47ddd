#include "tools/terminal/json_output.hpp"

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "slalom/core/error.hpp"

namespace slalom::tools {

void write_json(const nlohmann::ordered_json& result, const std::string& file) {
  const std::string text = result.dump(2) + "\n";
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
