#include "tools/recording/driven_recording.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string_view>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "src/evaluation/json.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t max_bytes = std::uintmax_t{1} << 32;  // size of a recording
constexpr std::size_t max_line = std::size_t{1} << 22;         // bytes of a line, without its end
constexpr double spacing = 0.1;                                // m between the points that are kept
constexpr double meeting = 1.0;                                // m, within which a lap ends where it began
constexpr double min_lap = 10;                                 // m

std::ifstream open_recording(const std::string& file) {
  if (fs::is_directory(file)) throw IoError(file, 0, "is a folder; a recording is a file");
  if (!fs::is_regular_file(file)) throw IoError(file, 0, "cannot be read: it must be a regular file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw cannot_open(file);
  if (const auto size = fs::file_size(file); size > max_bytes)
    throw IoError(
        file, 0,
        "has " + std::to_string(size) + " bytes; at most " + std::to_string(max_bytes) + " are read");
  return stream;
}

/// An element of a tick's list, NaN where it is null.
double entry(const Json& tick, const char* key, std::size_t index) {
  const Json& values = member(tick, key);
  if (!values.is_array() || values.size() <= index || !(values[index].is_number() || values[index].is_null()))
    throw std::invalid_argument("key '" + std::string(key) + "' must be a list of numbers");
  return values[index].is_null() ? std::numeric_limits<double>::quiet_NaN() : values[index].get<double>();
}

}  // namespace

std::vector<vehicle::DrivenSample> read_driven_samples(const std::string& file) {
  std::ifstream stream = open_recording(file);
  std::vector<vehicle::DrivenSample> samples;
  std::string buffer(max_line + 1, '\0');
  int number = 1;
  for (; stream.getline(buffer.data(), static_cast<std::streamsize>(buffer.size())); ++number) {
    const bool is_whole = !stream.eof();
    const std::string_view line(buffer.data(), static_cast<std::size_t>(stream.gcount()) - is_whole);
    // The magic bytes of an MCAP file.
    if (number == 1 && line.substr(0, 5) == "\x89MCAP")
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
      if (!is_whole && number > 1)
        throw IoError(file, number, "the recording was cut in this line; remove it");
      throw IoError(file, number, std::string("must be a record of a recording: ") + error.what());
    }
  }
  if (stream.bad()) throw IoError(file, number, "cannot be read");
  if (!stream.eof())
    throw IoError(file, number, "is longer than " + std::to_string(max_line) + " bytes: it is not a record");
  return samples;
}

vehicle::GuideLine driven_line(const std::string& file) {
  vehicle::GuideLine line;
  line.closed = false;
  double driven = 0, nearest = meeting;
  std::size_t lap = 0;  // points of the first lap, if one was driven
  for (const vehicle::DrivenSample& sample : read_driven_samples(file)) {
    if (!std::isfinite(sample.x) || !std::isfinite(sample.y)) continue;
    if (!line.points.empty()) {
      const double way = std::hypot(sample.x - line.points.back().x, sample.y - line.points.back().y);
      if (way < spacing) continue;
      driven += way;
    }
    line.points.push_back({sample.x, sample.y});
    const maps::Point& first = line.points.front();
    const double apart = std::hypot(sample.x - first.x, sample.y - first.y);
    if (driven < min_lap) continue;
    if (apart < nearest) {
      nearest = apart;
      lap = line.points.size();
    } else if (lap > 0) {
      break;  // the place where the lap ended is behind
    }
  }
  if (lap > 0) {
    line.closed = true;
    line.points.resize(lap - (nearest < spacing ? 1 : 0));
  }
  if (line.points.size() < 4) throw IoError(file, 0, "must be the recording of a drive of at least 0.4 m");
  return line;
}

}  // namespace slalom::tools
