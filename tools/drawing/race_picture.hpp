#pragma once

#include "slalom/evaluation/race.hpp"

namespace slalom::tools {

/// A lap and its name in the key.
struct NamedLap {
  std::string name;
  const evaluation::RacingLap& lap;
};

/// The content of a picture of a lap against the clock.
struct RacePicture {
  NamedLap lap;       ///< the lap that is shown
  NamedLap profile;   ///< the lap of the course's speed profile
  double length = 0;  ///< m, of the lap
  double grip = 0;    ///< m/s^2, radius of the friction circle
  std::string title, facts;
};

/// Draws the speed along the lap beside the profile, how far the lap is behind along the way, and its
/// accelerations in the friction circle. Writes PNG, SVG or PDF; throws IoError.
void draw_race(const RacePicture& picture, const std::filesystem::path& file);

}  // namespace slalom::tools
