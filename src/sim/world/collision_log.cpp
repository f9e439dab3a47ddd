#include "slalom/sim/collision_log.hpp"

#include <algorithm>

namespace slalom::sim {

void CollisionLog::update(const World& world, std::size_t car) {
  const Observation seen = world.observe(car);
  if (!seen.collides()) return;
  wall_ = wall_ || seen.wall;
  for (const int body : seen.colliding) {
    const auto at = std::lower_bound(bodies_.begin(), bodies_.end(), body);
    if (at == bodies_.end() || *at != body) bodies_.insert(at, body);
  }
  const auto flags = world.flags().subspan(world.cars());
  const auto same = [&](const std::vector<std::uint8_t>& pattern) {
    return std::equal(pattern.begin(), pattern.end(), flags.begin(), flags.end());
  };
  if (std::none_of(patterns_.begin(), patterns_.end(), same))
    patterns_.emplace_back(flags.begin(), flags.end());
}

}  // namespace slalom::sim
