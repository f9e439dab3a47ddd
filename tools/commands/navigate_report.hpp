#pragma once

#include <nlohmann/json_fwd.hpp>

#include "slalom/evaluation/rooms/room_drive.hpp"

namespace slalom::tools {

/// The drives of a driver in a scenario, one for each seed.
struct RoomSeries {
  const evaluation::RoomScenario* scenario;   ///< not null
  std::string driver;                         ///< as the tables call it
  std::vector<evaluation::RoomDrive> drives;  ///< in the order of the seeds
};

/// Whether a drive ended with an overlap, be it that somebody walked into the robot.
bool collided(const evaluation::RoomDrive& drive);

/// Means, intervals and every drive.
nlohmann::ordered_json summary_of(const RoomSeries& series);
/// Prints how often each driver succeeds, the figures, and how the others differ from the first driver on the
/// same scenarios and seeds, in at most 100 columns.
void print(const std::vector<RoomSeries>& all, std::FILE* out);

/// Writes the picture of a scenario, NAME.png, to this folder: the ways that all drivers took, and of the
/// first drive robot and people when one of them was nearest to it. Throws IoError if it cannot be written.
void draw(const std::vector<RoomSeries>& all, const evaluation::RoomScenario& scenario,
          const std::string& folder);

}  // namespace slalom::tools
