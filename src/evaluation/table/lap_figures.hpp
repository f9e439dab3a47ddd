#pragma once

#include "slalom/evaluation/lap_table.hpp"

namespace slalom::evaluation {

/// Returns a row's figures of a tracker.
TrackingFigures figures_of(const TrackingRecord& record);
/// Returns a row's figures of opponents.
OvertakingFigures figures_of(const OvertakingRecord& record);

}  // namespace slalom::evaluation
