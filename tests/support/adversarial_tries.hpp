#pragma once

#include <gtest/gtest.h>

#include <cstdint>

#include "support/adversary.hpp"
#include "support/promise.hpp"
#include "support/repetitions.hpp"

namespace slalom::testing {

/// Calls `attempt(adversary, seed)` with one seed after another until it has counted `made` up to `tries`.
/// A finding fails the test with its seed. Other programs slow down a shared machine, so that a slow call is
/// a finding only if it is slow three times.
template <class Attempt>
void try_adversaries(long tries, const long& made, const Attempt& attempt) {
  int slow = 0;
  for (std::uint64_t seed = first_seed(); made < tries;) {
    Adversary adversary(seed);
    try {
      attempt(adversary, seed);
    } catch (const SlowCall& call) {
      if (++slow < 3) continue;
      FAIL() << "seed " << seed << ", three times: " << call.what();
    } catch (const Finding& finding) {
      FAIL() << "seed " << seed << ": " << finding.what();
    }
    slow = 0;
    ++seed;
  }
}

}  // namespace slalom::testing
