#pragma once

namespace slalom::testing {

/// Calls of `operator new` so far by every thread of the program. A test program that calls it links
/// `slalom_test_allocations`, whose replacement of `operator new` counts.
long allocations() noexcept;

}  // namespace slalom::testing
