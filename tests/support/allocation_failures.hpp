#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <new>

#include "support/allocations.hpp"

namespace slalom::testing {

/// Calls `make` again and again, each time with another of its allocations failing: every one up to `each`,
/// from there on fewer and fewer; it then prints how many failed. Expects that it throws std::bad_alloc or
/// returns what it returns undisturbed, and that nothing stays in memory. Returns how many allocations `make`
/// has. `make` returns a value that can be compared without an allocation, and is called once before, so that
/// what a process makes only once is there.
template <class Make>
long fail_every_allocation(Make&& make, long each = 2000) {
  make();
  const auto expected = make();
  long failed = 0;
  for (long number = 0;; number += 1 + (number > each ? number / 50 : 0)) {
    const long before = live_allocations();
    bool same = true;
    fail_allocation_after(number);
    try {
      same = make() == expected;
    } catch (const std::bad_alloc&) {
    } catch (const std::exception& error) {
      ADD_FAILURE() << "allocation " << number << ": another error, " << error.what();
    }
    const bool has_failed = stop_failing();
    EXPECT_TRUE(same) << "allocation " << number << ": another result";
    EXPECT_EQ(live_allocations(), before) << "allocation " << number << ": memory is lost";
    if (!has_failed) {
      EXPECT_TRUE(make() == expected) << "after all failures";
      if (failed < number)
        std::printf("%ld of about %ld allocations failed, among them the first %ld\n", failed, number, each);
      return number;
    }
    ++failed;
    if (::testing::Test::HasFailure()) return number;
  }
}

}  // namespace slalom::testing
