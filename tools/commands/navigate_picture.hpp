#pragma once

#include <string>
#include <vector>

#include "tools/commands/navigate_report.hpp"

namespace slalom::tools {

/// Writes the picture of a scenario, NAME.png, to this folder: the ways that all drivers took, and of the
/// first drive where robot and people were every 3 s. Throws IoError if it cannot be written.
void draw(const std::vector<RoomSeries>& all, const evaluation::RoomScenario& scenario,
          const std::string& folder);

}  // namespace slalom::tools
