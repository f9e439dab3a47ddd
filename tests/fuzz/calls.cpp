// Controllers, planners, navigators and trackers as state machines: bytes choose options, then the calls.
#include "fuzz/target.hpp"
#include "navigation/navigator_calls.hpp"
#include "solvers/controller_calls.hpp"
#include "solvers/solver_contract.hpp"
#include "support/random_bytes.hpp"
#include "tracking/tracker_calls.hpp"
#include "vehicle/planner/planner_calls.hpp"

namespace slalom::fuzz {
namespace {

const Target controller_target(
    "controller", 1024, []() -> Seeds { return random_bytes(40, 300); },
    [](std::string_view bytes) {
      static const auto sets = testing::option_sets();
      testing::Adversary adversary(bytes);
      testing::ControllerTally tally;
      const int set = adversary.below(static_cast<int>(sets.size()));
      testing::call_any_controller(sets[static_cast<std::size_t>(set)].options, adversary, tally);
      return tally.plans > 0;
    });

const Target planner_target(
    "planner", 4096, []() -> Seeds { return random_bytes(20, 1500); },
    [](std::string_view bytes) {
      testing::Adversary adversary(bytes);
      testing::PlannerTally tally;
      testing::call_planner(adversary, 40, tally);
      return tally.updates > 0;
    });

const Target navigator_target(
    "navigator", 4096, []() -> Seeds { return random_bytes(20, 1500); },
    [](std::string_view bytes) {
      testing::Adversary adversary(bytes);
      navigation::NavigatorTally tally;
      const navigation::Hall hall(adversary);
      const double front = adversary.within(0.05, 1), width = adversary.within(0.05, 2);
      const auto footprint = navigation::Footprint::rectangle(front, adversary.within(0.05, 1), width);
      navigation::call_navigator(adversary, hall, tally, footprint);
      return tally.updates > 0;
    });

const Target tracker_target(
    "tracker", 4096, []() -> Seeds { return random_bytes(20, 1500); },
    [](std::string_view bytes) {
      testing::Adversary adversary(bytes);
      tracking::TrackerTally tally;
      tracking::call_tracker(adversary, tally);
      return tally.updates > 0;
    });

}  // namespace
}  // namespace slalom::fuzz
