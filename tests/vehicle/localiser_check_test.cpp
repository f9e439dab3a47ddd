#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "navigation/grids.hpp"
#include "slalom/vehicle/localisation/localiser.hpp"
#include "support/adversarial_tries.hpp"
#include "support/adversary.hpp"
#include "support/promise.hpp"

/// The output of a localiser is finite, whatever enters it.
namespace slalom::vehicle::localiser_check_test {
namespace {

maps::OccupancyGrid room() {
  maps::OccupancyGrid map = navigation::free_grid(-2, -2, 4, 4);
  navigation::fill(map, -2, -2, 2, -1.8);
  navigation::fill(map, -2, 1.8, 2, 2);
  navigation::fill(map, -2, -2, -1.8, 2);
  navigation::fill(map, 1, -2, 2, 1);
  return map;
}

struct Tally {
  long updates = 0;
  long statuses[6] = {};
};

/// Throws Finding unless an estimate is finite and its shares are shares.
void check(const LocaliserOutput& out) {
  double sum = out.pose.x + out.pose.y + out.pose.yaw;
  for (const auto& row : out.covariance)
    for (const double value : row) sum += value;
  testing::require(std::isfinite(sum), "the estimate is finite");
  for (const double share : {out.fit, out.share, out.health})
    testing::require(share >= 0 && share <= 1 + 1e-9, "shares are from 0 to 1");
  testing::require(out.particles >= 0 && out.beams >= 0, "numbers are not negative");
}

/// One localiser and a few dozen updates. Throws Finding.
void call_localiser(testing::Adversary& adversary, const maps::OccupancyGrid& map, Tally& tally) {
  Localiser localiser(map, {.seed = static_cast<std::uint64_t>(adversary.below(1000))});
  std::vector<float> ranges(181);
  double stamp = 0;
  for (int i = 0; i < 25; ++i) {
    const bool hostile = adversary.once_in(5);
    const auto value = [&](double low, double high) {
      return hostile ? adversary.any(low, high) : adversary.within(low, high);
    };
    if (adversary.once_in(20)) localiser.start_at({value(-1, 1), value(-1, 1), value(-4, 4)});
    if (adversary.once_in(30)) localiser.start_everywhere();
    ranges.resize(static_cast<std::size_t>(adversary.once_in(10) ? adversary.below(3000) : 181));
    for (float& range : ranges) range = static_cast<float>(value(0.5, 3));
    stamp += 0.025;
    LocaliserInput input;
    input.scan = {ranges, value(-1.6, -1.5), value(0.017, 0.018), 0.05, 30};
    input.odometry = {0.02 * i + value(0, 0.01), value(0, 0.01), value(0, 0.01)};
    input.stamp = hostile ? adversary.any(0, 10) : stamp;
    const LocaliserOutput& out = localiser.update(input);
    check(out);
    ++tally.updates;
    ++tally.statuses[static_cast<int>(out.status)];
  }
}

TEST(LocaliserCheck, EstimatesAreFiniteForAnyInput) {
  const maps::OccupancyGrid map = room();
  Tally tally;
  testing::try_adversaries(
      testing::repetitions(600), tally.updates,
      [&](testing::Adversary& adversary, std::uint64_t) { call_localiser(adversary, map, tally); });
  for (const LocaliserStatus status : {LocaliserStatus::uncertain, LocaliserStatus::bad_scan,
                                       LocaliserStatus::bad_odometry, LocaliserStatus::stale})
    EXPECT_GT(tally.statuses[static_cast<int>(status)], 0) << name(status);
}

}  // namespace
}  // namespace slalom::vehicle::localiser_check_test
