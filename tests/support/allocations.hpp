#pragma once

namespace slalom::testing {

/// Calls of `operator new` so far by every thread of the program. A test program that calls it links
/// `slalom_test_allocations`, whose replacement of `operator new` counts.
long allocations() noexcept;

/// Calls of `operator new` less those of `operator delete`: what is in memory now.
long live_allocations() noexcept;

/// Makes one allocation of this thread throw std::bad_alloc: the next if `others` is 0, otherwise the one
/// after `others` more.
void fail_allocation_after(long others) noexcept;
/// Ends this. Whether an allocation has failed.
bool stop_failing() noexcept;

}  // namespace slalom::testing
