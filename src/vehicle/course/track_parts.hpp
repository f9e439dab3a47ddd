#pragma once

#include "slalom/vehicle/course/track_generator.hpp"
#include "vehicle/course/curve.hpp"

namespace slalom::vehicle::detail {

/// The style of a character: its usual values, and the parameters of its polygons.
struct Style {
  const char* name;
  double top_speed;                   ///< m/s, usual
  double width;                       ///< m from wall to wall, usual
  double corner_spacing;              ///< m of centre line per corner
  double depth;                       ///< how far corners move inwards, as a fraction of the radius
  double stretch;                     ///< largest ratio of the sides
  double swirl;                       ///< largest rotation of the rim against the centre, rad
  double small_radius, large_radius;  ///< m, range of the radii of corners
  double smoothing;                   ///< m, standard deviation along the path
  double min_winding, max_winding;    ///< integral of |curvature| in multiples of 2 pi, at 60 m of length
};
const Style& style_of(TrackCharacter character) noexcept;

/// The tightest radius (m) of a centre line: the inner wall must fit, and a 1/10 car must be able to follow.
double min_radius(const TrackGeneratorOptions& options);

/// A closed centre line as generate_track specifies it, in equal steps of about 0.1 m, with its longest
/// extent about along x. Throws std::invalid_argument if none is found.
Curve make_centre_line(const TrackGeneratorOptions& options);

/// The row in the middle of the longest part of a closed line at (nearly) the highest speed, a good start.
std::size_t start_row(const std::vector<double>& speed);

}  // namespace slalom::vehicle::detail
