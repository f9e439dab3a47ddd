#include "slalom/sim/placement.hpp"

#include <algorithm>

#include "slalom/core/options.hpp"
#include "slalom/sim/gym.hpp"
#include "slalom/sim/shapes.hpp"

namespace slalom::sim {
namespace {

using std::numbers::pi;

void check(std::span<const maps::Point> path, int cars) {
  if (path.empty()) throw std::invalid_argument("path: must have at least one point to place cars at");
  if (path.size() > 0xffffffffu) throw std::invalid_argument("path: must have fewer than 2^32 points");
  slalom::detail::check("placement", {"cars", "", "", 0, 10000}, cars);
}

}  // namespace

std::vector<maps::Pose> place_at_random(std::span<const maps::Point> path, int cars, std::uint64_t seed) {
  check(path, cars);
  std::vector<maps::Pose> placed;
  for (int i = 0; i < cars; ++i) {
    NumpyRandom random(seed + static_cast<std::uint64_t>(i));
    const maps::Point& at = path[random.below(static_cast<std::uint32_t>(path.size()))];
    const double distance = random.uniform(0, 0.1);
    const double direction = random.uniform(-pi, pi);
    const double yaw = random.uniform(-pi, pi);
    placed.push_back({at.x + distance * std::cos(direction), at.y + distance * std::sin(direction), yaw});
  }
  return placed;
}

std::vector<maps::Pose> place_apart(std::span<const maps::Point> path, std::span<const double> room, int cars,
                                    std::uint64_t seed, const maps::Point& start, const CarParameters& car) {
  check(path, cars);
  if (!room.empty() && room.size() != path.size())
    throw std::invalid_argument("room: must have one entry per point of the path, or none");
  constexpr int attempts = 2000;
  const double scale = car.width / 0.31;
  const double radius = 0.1 * scale, gap = 1.5 * scale, keep_clear = 3.0 * scale, passage = 0.6 * scale;  // m
  NumpyRandom random(seed);
  std::vector<maps::Pose> placed;
  for (int attempt = 0; static_cast<int>(placed.size()) < cars; ++attempt) {
    if (attempt == attempts)
      throw std::runtime_error("only " + std::to_string(placed.size()) + " of " + std::to_string(cars) +
                               " parked cars could be placed in " + std::to_string(attempts) + " draws");
    const std::size_t row = random.below(static_cast<std::uint32_t>(path.size()));
    const double distance = radius * std::sqrt(random.uniform(0, 1));
    const double direction = random.uniform(-pi, pi);
    const maps::Pose pose{path[row].x + distance * std::cos(direction),
                          path[row].y + distance * std::sin(direction), random.uniform(-pi, pi)};
    if (std::hypot(pose.x - start.x, pose.y - start.y) < keep_clear) continue;
    // The car may lie across the road; on the side it is not moved towards at least this much stays open.
    if (!room.empty() && room[row] - std::hypot(car.length, car.width) / 2 < passage) continue;
    const Box wide{pose, car.length + 2 * gap, car.width + 2 * gap};
    const bool apart = std::all_of(placed.begin(), placed.end(), [&](const maps::Pose& other) {
      return signed_gap(wide, Box{other, car.length, car.width}) > 0;
    });
    if (apart) placed.push_back(pose);
  }
  return placed;
}

}  // namespace slalom::sim
