// Controllers, planners, navigators and trackers as state machines: bytes choose options, then the calls.
#include <cmath>
#include <stdexcept>
#include <vector>

#include "fuzz/target.hpp"
#include "navigation/navigator_calls.hpp"
#include "slalom/vehicle/localisation/localiser.hpp"
#include "solvers/controller_calls.hpp"
#include "solvers/solver_contract.hpp"
#include "tracking/tracker_calls.hpp"
#include "vehicle/planner/planner_calls.hpp"

namespace slalom::fuzz {
namespace {

const Target controller_target(
    "controller", 1024, []() -> Seeds { return random_bytes(40, 300); },
    [](std::string_view bytes) {
      static const auto sets = testing::option_sets();
      testing::Adversary adversary(bytes);
      const int set = adversary.below(static_cast<int>(sets.size()));
      return testing::call_any_controller(sets[set].options, adversary) > 0;
    },
    100);

const Target planner_target(
    "planner", 4096, []() -> Seeds { return random_bytes(20, 1500); },
    [](std::string_view bytes) {
      testing::Adversary adversary(bytes);
      return testing::call_planner(adversary, 40) > 0;
    },
    100);

const Target navigator_target(
    "navigator", 4096, []() -> Seeds { return random_bytes(20, 1500); },
    [](std::string_view bytes) {
      testing::Adversary adversary(bytes);
      const navigation::Hall hall(adversary);
      std::vector<maps::Point> outline(3 + adversary.below(8));
      for (std::size_t i = 0; i < outline.size(); ++i) {
        const double angle = 6.28 * i / outline.size();
        const double radius = adversary.once_in(8) ? adversary.any(0.05, 5) : adversary.within(0.05, 1);
        outline[i] = {radius * std::cos(angle), radius * std::sin(angle)};
      }
      try {
        return navigation::call_navigator(adversary, hall, navigation::Footprint(outline));
      } catch (const std::invalid_argument&) {  // no outline
        return false;
      }
    },
    100);

const Target tracker_target(
    "tracker", 4096, []() -> Seeds { return random_bytes(20, 1500); },
    [](std::string_view bytes) {
      testing::Adversary adversary(bytes);
      return tracking::call_tracker(adversary) > 0;
    },
    100);

/// Throws Finding unless an estimate is finite and its shares are shares.
void check(const vehicle::LocaliserOutput& out) {
  double sum = out.pose.x + out.pose.y + out.pose.yaw;
  for (const auto& row : out.covariance)
    for (const double value : row) sum += value;
  require(std::isfinite(sum), "the estimate is finite");
  for (const double share : {out.fit, out.share, out.health})
    require(share >= 0 && share <= 1 + 1e-9, "shares are from 0 to 1");
  require(out.particles >= 0 && out.beams >= 0, "numbers are not negative");
}

const Target localiser_target(
    "localiser", 4096, []() -> Seeds { return random_bytes(20, 1500); },
    [](std::string_view bytes) {
      static const maps::OccupancyGrid map = tracking::room();
      testing::Adversary adversary(bytes);
      vehicle::Localiser localiser(map, {.seed = static_cast<std::uint64_t>(adversary.below(1000))});
      std::vector<float> ranges;
      for (int i = 0; i < 25; ++i) {
        const bool hostile = adversary.once_in(5);
        const auto value = [&](double low, double high) {
          return hostile ? adversary.any(low, high) : adversary.within(low, high);
        };
        if (adversary.once_in(20)) localiser.start_at({value(-1, 1), value(-1, 1), value(-4, 4)});
        if (adversary.once_in(30)) localiser.start_everywhere();
        ranges.resize(adversary.once_in(10) ? adversary.below(3000) : 181);
        if (hostile || i < 2)
          for (float& range : ranges) range = static_cast<float>(value(0.5, 3));
        vehicle::LocaliserInput input{.scan = {ranges, value(-1.6, -1.5), value(0.017, 0.018), 0.05, 30},
                                      .odometry = {0.02 * i + value(0, 0.01), value(0, 0.01), value(0, 0.01)},
                                      .stamp = hostile ? adversary.any(0, 10) : 0.025 * i};
        check(localiser.update(input));
      }
      return true;
    },
    100);

}  // namespace
}  // namespace slalom::fuzz
