#pragma once

#include "slalom/vehicle/course/track_generator.hpp"
#include "vehicle/course/closed_curve.hpp"

namespace slalom::vehicle::detail {

/// The map of a track: cells are free up to half the width from the centre line, occupied in the wall beyond,
/// unknown elsewhere. Cell borders lie on multiples of the resolution.
maps::OccupancyGrid draw_map(const Curve& centre_line, const TrackGeneratorOptions& options);

}  // namespace slalom::vehicle::detail
