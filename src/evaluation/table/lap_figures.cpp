#include "evaluation/table/lap_figures.hpp"

#include <algorithm>

#include "slalom/evaluation/statistics.hpp"

namespace slalom::evaluation {

TrackingFigures figures_of(const TrackingRecord& record) {
  TrackingFigures figures{record.in_view,       record.detected,      record.long_in_view,
                          record.long_detected, record.false_objects, record.position_error,
                          record.speed_error,   record.yaw_error};
  if (!record.update_ms.empty()) figures.update_p99 = percentile(record.update_ms, 0.99);
  return figures;
}

OvertakingFigures figures_of(const OvertakingRecord& record) {
  OvertakingFigures figures{.met = static_cast<int>(record.encounters.size()),
                            .contacts = record.contacts,
                            .caused = record.caused};
  for (const Encounter& each : record.encounters) {
    figures.side_changes += each.side_changes;
    figures.not_overtaken += each.end == EncounterEnd::not_overtaken;
    if (each.end != EncounterEnd::overtaken) continue;
    ++figures.overtaken;
    figures.duration += each.duration;
  }
  figures.duration /= std::max(figures.overtaken, 1);
  return figures;
}

}  // namespace slalom::evaluation
