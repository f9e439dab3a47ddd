#include "tools/json_lines/json_repair.hpp"

#include <filesystem>
#include <fstream>

#include "slalom/core/error.hpp"
#include "src/evaluation/json.hpp"
#include "tools/json_lines/record_lines.hpp"

namespace slalom::tools {

bool is_json_recording(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return false;
  return std::ifstream(file, std::ios::binary).get() == '{';
}

RepairedLines repair_json_recording(const std::string& file, std::ostream& out) {
  RepairedLines done;
  RecordLines lines(file);
  std::string line;
  while (lines.next(line)) {
    try {
      const auto type = member<std::string>(parse_json(line), "type");
      if (lines.number() == 1 && type != "recording")
        throw IoError(file, 1, "must be the first line of a recording");
    } catch (const std::invalid_argument& error) {
      if (lines.ended())
        throw IoError(file, lines.number(), std::string("must be a record of a recording: ") + error.what());
      done.lost = line.size();
      break;
    }
    out << line << '\n';
    ++done.records;
  }
  if (done.records == 0) throw IoError(file, 0, "has no whole record");
  return done;
}

}  // namespace slalom::tools
