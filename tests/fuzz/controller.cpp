// Controllers as state machines: bytes choose method, problem and options, then a sequence of calls.
#include "solvers/controller_calls.hpp"

#include "fuzz/target.hpp"
#include "solvers/solver_contract.hpp"
#include "support/random_bytes.hpp"

namespace slalom::fuzz {
namespace {

std::vector<std::string> seeds() {
  return random_bytes(40, 300);
}

bool run(std::string_view bytes) {
  static const auto sets = testing::option_sets();
  testing::Adversary adversary(bytes);
  testing::ControllerTally tally;
  const int set = adversary.below(static_cast<int>(sets.size()));
  testing::call_any_controller(sets[static_cast<std::size_t>(set)].options, adversary, tally);
  return tally.plans > 0;
}

const Target target("controller", 1024, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
