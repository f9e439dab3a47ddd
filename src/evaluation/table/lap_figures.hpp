#pragma once

#include "slalom/evaluation/lap_table.hpp"

namespace slalom::evaluation {

/// What a row of the table says about a tracker.
TrackingFigures figures_of(const TrackingRecord& record);
/// What a row of the table says about opponents.
OvertakingFigures figures_of(const OvertakingRecord& record);

}  // namespace slalom::evaluation
