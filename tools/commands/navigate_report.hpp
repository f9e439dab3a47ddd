#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "slalom/evaluation/json.hpp"
#include "slalom/evaluation/rooms/room_drive.hpp"

namespace slalom::tools {

/// The drives of a driver in a scenario, one for each seed.
struct RoomSeries {
  const evaluation::RoomScenario* scenario;
  std::string driver;  ///< as the tables call it
  std::vector<evaluation::RoomDrive> drives;
};

/// Whether a drive ended with an overlap, be it that somebody walked into the robot.
bool collided(const evaluation::RoomDrive& drive);

/// Means, intervals and every drive.
Json summary_of(const RoomSeries& series);
/// One line of words for the terminal, and the line above them.
void print_heading(std::ostream& out);
void print_row(const RoomSeries& series, std::ostream& out);

/// A table in Markdown: each series, the sums of each driver over all scenarios, and how the others differ
/// from the first one on the same scenarios and seeds.
std::string markdown_table(const std::vector<RoomSeries>& all);

/// A picture of a scenario for this folder: the ways that all drivers took, and of the first drive where
/// robot and people were every 3 s.
void draw(const std::vector<RoomSeries>& all, const evaluation::RoomScenario& scenario,
          const std::string& folder);

}  // namespace slalom::tools
