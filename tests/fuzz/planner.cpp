// Planners as state machines: bytes choose model, method and options, then scans and odometry.
#include "fuzz/target.hpp"
#include "support/random_bytes.hpp"
#include "vehicle/planner/planner_calls.hpp"

namespace slalom::fuzz {
namespace {

std::vector<std::string> seeds() {
  return random_bytes(20, 1500);
}

bool run(std::string_view bytes) {
  testing::Adversary adversary(bytes);
  testing::PlannerTally tally;
  testing::call_planner(adversary, 40, tally);
  return tally.updates > 0;
}

const Target target("planner", 4096, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
