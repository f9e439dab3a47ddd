#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>

#include "support/adversary.hpp"
#include "support/promise.hpp"

namespace slalom::testing {

/// Number of tries of a property: the environment's SLALOM_CALLS, or `otherwise`.
inline long repetitions(long otherwise) {
  const char* set = std::getenv("SLALOM_CALLS");
  return set ? std::strtol(set, nullptr, 10) : otherwise;
}

/// The first seed of such tries: the environment's SLALOM_SEED, or 0. A failure names the seed to begin with.
inline std::uint64_t first_seed() {
  const char* set = std::getenv("SLALOM_SEED");
  return set ? std::strtoull(set, nullptr, 10) : 0;
}

/// Calls `attempt(adversary, seed)` with one seed after another until it has counted `made` up to `tries`. A
/// finding fails the test with its seed.
template <class Attempt>
void try_adversaries(long tries, const long& made, const Attempt& attempt) {
  for (std::uint64_t seed = first_seed(); made < tries; ++seed) {
    try {
      repeat_if_slow([&] {
        Adversary adversary(seed);
        attempt(adversary, seed);
      });
    } catch (const Finding& finding) {
      FAIL() << "seed " << seed << ": " << finding.what();
    }
  }
}

}  // namespace slalom::testing
