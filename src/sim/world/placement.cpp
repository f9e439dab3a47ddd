#include "slalom/sim/placement.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "sim/validation.hpp"
#include "slalom/sim/numpy_random.hpp"
#include "slalom/sim/shapes.hpp"

namespace slalom::sim {
namespace {

using std::numbers::pi;

void check(std::span<const maps::Point> path, int cars, double radius) {
  if (path.empty()) throw std::invalid_argument("path: must have at least one point to place cars at");
  if (path.size() > 0xffffffffu) throw std::invalid_argument("path: must have fewer than 2^32 points");
  detail::require_range("cars", cars, 0, 10000);
  detail::require_range("radius", radius, 0, 1000);
}

}  // namespace

std::vector<Placement> place_at_random(std::span<const maps::Point> path, int cars, std::uint64_t seed,
                                       double radius) {
  check(path, cars, radius);
  std::vector<Placement> placed;
  for (int i = 0; i < cars; ++i) {
    NumpyRandom random(seed + static_cast<std::uint64_t>(i));
    const std::size_t row = random.below(static_cast<std::uint32_t>(path.size()));
    const double distance = random.uniform(0, radius);
    const double direction = random.uniform(-pi, pi);
    const double yaw = random.uniform(-pi, pi);
    placed.push_back(
        {{path[row].x + distance * std::cos(direction), path[row].y + distance * std::sin(direction), yaw},
         row});
  }
  return placed;
}

PlacementRules placement_of(const CarParameters& car) {
  PlacementRules rules;
  const double scale = car.width / rules.width;
  for (double* const length : {&rules.radius, &rules.gap, &rules.keep_clear, &rules.passage})
    *length *= scale;
  rules.length = car.length;
  rules.width = car.width;
  return rules;
}

std::vector<Placement> place_apart(std::span<const maps::Point> path, std::span<const double> room, int cars,
                                   std::uint64_t seed, const maps::Point& start,
                                   const PlacementRules& rules) {
  check(path, cars, rules.radius);
  if (!room.empty() && room.size() != path.size())
    throw std::invalid_argument("room: must have one entry per point of the path, or none");
  NumpyRandom random(seed);
  std::vector<Placement> placed;
  for (int attempt = 0; static_cast<int>(placed.size()) < cars; ++attempt) {
    if (attempt == rules.attempts)
      throw std::runtime_error("only " + std::to_string(placed.size()) + " of " + std::to_string(cars) +
                               " parked cars could be placed in " + std::to_string(rules.attempts) +
                               " draws");
    const std::size_t row = random.below(static_cast<std::uint32_t>(path.size()));
    const double distance = rules.radius * std::sqrt(random.uniform(0, 1));
    const double direction = random.uniform(-pi, pi);
    const maps::Pose pose{path[row].x + distance * std::cos(direction),
                          path[row].y + distance * std::sin(direction), random.uniform(-pi, pi)};
    if (std::hypot(pose.x - start.x, pose.y - start.y) < rules.keep_clear) continue;
    // The car may lie across the road; on the side that it is not moved towards at least this much stays
    // open.
    const double reach = std::hypot(rules.length, rules.width) / 2;
    if (!room.empty() && room[row] - reach < rules.passage) continue;
    const Box wide{pose, rules.length + 2 * rules.gap, rules.width + 2 * rules.gap};
    const bool apart = std::all_of(placed.begin(), placed.end(), [&](const Placement& other) {
      return signed_gap(wide, Box{other.pose, rules.length, rules.width}) > 0;
    });
    if (apart) placed.push_back({pose, row});
  }
  return placed;
}

}  // namespace slalom::sim
