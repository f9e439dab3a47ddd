#pragma once

#include "json/json.hpp"
#include "slalom/evaluation/lap.hpp"

namespace slalom::tools {

/// "finished", "interrupted" or "timeout".
const char* end_name(const evaluation::LapResult& lap);

/// A lap as results have it. Nothing in it depends on the clock of the wall.
Json lap_json(const evaluation::LapResult& lap, int number);

/// sqrt(mean of squares); 0 without values.
double root_mean_square(const std::vector<float>& values);

/// Percentiles by nearest rank of wall-clock times, ms; null without any.
Json times_json(const std::vector<float>& milliseconds);

/// All solve times of laps, ms.
std::vector<float> solve_times(const std::vector<evaluation::LapResult>& laps);

}  // namespace slalom::tools
