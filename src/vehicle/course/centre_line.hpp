#pragma once

#include "slalom/vehicle/course/track_generator.hpp"
#include "vehicle/course/closed_curve.hpp"

namespace slalom::vehicle::detail {

/// The tightest radius (m) that a centre line may have: the inner wall must fit, and a 1/10 car must be able
/// to follow it.
double min_radius(const TrackGeneratorOptions& options);

/// A closed centre line as generate_track specifies it, in equal steps of about 0.1 m, with its longest
/// extent about along x. Throws std::invalid_argument if none is found.
Curve make_centre_line(const TrackGeneratorOptions& options);

}  // namespace slalom::vehicle::detail
