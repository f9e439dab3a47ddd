#pragma once

#include "slalom/tracking/tracker_options.hpp"
#include "tracking/readings.hpp"
#include "tracking/tracked.hpp"

namespace slalom::tracking {

/// Consecutive readings [begin, end) of one surface.
struct Cluster {
  std::size_t begin, end;
};

/// m, the largest diameter of an object.
double max_diameter(const TrackerOptions& options) noexcept;
/// m, the distance of the two readings farthest from the first one and from each other; at most the diameter.
double diameter(std::span<const Reading> readings) noexcept;

/// Divides readings, in the order of their beams, into as many clusters as `clusters` has room for.
void find_clusters(std::span<const Reading> readings, double increment, const TrackerOptions& options,
                   std::vector<Cluster>& clusters) noexcept;

/// Which object each reading belongs to: that of the largest likelihood in whose gate it is, by its distance
/// to the outline of the predicted box; -1 for none. A cluster that is small enough for one object, and most
/// of which is in the gates of one object alone, belongs to that as a whole. `owners` has room for all.
void associate(std::span<const Reading> readings, std::span<const Cluster> clusters,
               std::span<const Tracked> objects, const TrackerOptions& options,
               std::vector<int>& owners) noexcept;

/// m, from a point to the outline of a box, from inside or outside.
double outline_distance(const maps::Point& point, const Tracked& object) noexcept;

}  // namespace slalom::tracking
