#pragma once

namespace slalom::testing {

/// Calls of operator new by this thread so far.
long allocations() noexcept;

}  // namespace slalom::testing
