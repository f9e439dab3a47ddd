#include "tools/scenario/start_pose.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "tools/command_line/command.hpp"

namespace slalom::tools {

maps::Pose parse_start(const std::string& text) {
  std::array<double, 3> values{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto [stopped, error] = std::from_chars(at, end, values[i]);
    const bool separated = i + 1 < values.size() ? stopped < end && *stopped == ',' : stopped == end;
    if (error != std::errc{} || !separated || !std::isfinite(values[i]))
      throw CommandLineError("--start", text, "must be x,y,yaw: three finite numbers, in m, m, rad");
    at = stopped + 1;
  }
  return {values[0], values[1], values[2]};
}

}  // namespace slalom::tools
