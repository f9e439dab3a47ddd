#pragma once

#include <gtest/gtest.h>

#include <cstdint>

#include "support/adversary.hpp"
#include "support/promise.hpp"
#include "support/repetitions.hpp"

namespace slalom::testing {

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
