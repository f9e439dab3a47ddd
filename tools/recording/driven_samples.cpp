#include "tools/recording/driven_samples.hpp"

#include <limits>

#include "slalom/core/error.hpp"
#include "src/evaluation/json.hpp"
#include "tools/recording/record_lines.hpp"

namespace slalom::tools {
namespace {

/// An element of a tick's list, NaN where it is null.
double entry(const Json& tick, const char* key, std::size_t index) {
  const Json& values = member(tick, key);
  if (!values.is_array() || values.size() <= index || !(values[index].is_number() || values[index].is_null()))
    throw std::invalid_argument("key '" + std::string(key) + "' must be a list of numbers");
  return values[index].is_null() ? std::numeric_limits<double>::quiet_NaN() : values[index].get<double>();
}

}  // namespace

std::vector<vehicle::DrivenSample> read_driven_samples(const std::string& file) {
  RecordLines lines(file);
  std::vector<vehicle::DrivenSample> samples;
  std::string line;
  while (lines.next(line)) {
    const int number = lines.number();
    // The magic bytes of an MCAP file.
    if (number == 1 && line.rfind("\x89MCAP", 0) == 0)
      throw IoError(file, 0,
                    "is an MCAP recording; must be JSON lines, which slalom drive --record writes to a file "
                    "whose name does not end in .mcap");
    try {
      const Json record = parse_json(line);
      const auto type = member<std::string>(record, "type");
      if (number == 1 && type != "recording") throw IoError(file, 1, "must be the first line of a recording");
      if (type != "tick") continue;
      samples.push_back({member<double>(record, "time"), entry(record, "odometry", 0),
                         entry(record, "odometry", 1), entry(record, "odometry", 2),
                         entry(record, "odometry", 3), entry(record, "command", 0)});
    } catch (const std::invalid_argument& error) {
      if (!lines.ended() && number > 1)
        throw IoError(file, number, "the recording was cut in this line; remove it");
      throw IoError(file, number, std::string("must be a record of a recording: ") + error.what());
    }
  }
  return samples;
}

}  // namespace slalom::tools
