// Results of races, as `slalom race --compare` reads them.
#include "tools/racing/race_result.hpp"

#include <cmath>

#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"
#include "src/evaluation/json.hpp"

namespace slalom::fuzz {
namespace {

constexpr double length = 20;  // m

Json settings() {
  return {{"course", "wren"}, {"start", Json::array({0.0, 0.0, 0.0})}};
}

evaluation::RacingLap lap(bool standing, double speed) {
  evaluation::RacingLap lap;
  lap.standing = standing;
  lap.seed = 3;
  for (int i = 0; i <= 4; ++i) {
    const double distance = length * i / 4;
    lap.samples.push_back(
        {.distance = distance, .time = distance / speed, .speed = speed, .longitudinal = 0.5, .lateral = -2});
  }
  lap.sector = evaluation::sector_times(lap.samples, length);
  return lap;
}

std::vector<std::string> seeds() {
  tools::RaceResult race;
  race.length = length;
  race.grip = 8;
  race.profile = lap(false, 5);
  race.profile_from_rest = lap(true, 4);
  race.laps = {lap(true, 3), lap(false, 4.5)};
  Json both = tools::race_json(race);
  both["settings"] = settings();
  race.laps.pop_back();
  Json standing = tools::race_json(race);
  standing["settings"] = settings();
  return {both.dump(), standing.dump(2)};
}

bool run(std::string_view bytes) {
  static const evaluation::RacingLap own = lap(false, 4);
  try {
    const tools::OtherRun other = tools::read_run(scratch_file("race.json", bytes), settings(), length);
    require(other.flying || other.standing, "a result has a lap");
    for (const auto& read : {other.flying, other.standing}) {
      if (!read) continue;
      require(read->samples.size() >= 2, "a lap has samples");
      for (int i = 0; i <= 10; ++i)
        require(std::isfinite(evaluation::time_behind(own.samples, read->samples, length * i / 10)),
                "the time behind another lap is finite");
    }
    return true;
  } catch (const IoError&) {
    return false;
  }
}

const Target target("race_result", 1 << 14, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
