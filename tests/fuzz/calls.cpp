// Controllers, planners, navigators and trackers as state machines: bytes choose options, then the calls.
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "fuzz/target.hpp"
#include "navigation/navigator_calls.hpp"
#include "solvers/controller_calls.hpp"
#include "solvers/solver_contract.hpp"
#include "tracking/tracker_calls.hpp"
#include "vehicle/planner/planner_calls.hpp"

namespace slalom::fuzz {
namespace {

/// `count` texts of `size` random bytes, the same at every call.
Seeds random_bytes(int count, std::size_t size) {
  std::mt19937_64 random(1);
  Seeds all(count, std::string(size, '\0'));
  for (std::string& each : all)
    for (char& byte : each) byte = static_cast<char>(random() & 255u);
  return all;
}

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

}  // namespace
}  // namespace slalom::fuzz
