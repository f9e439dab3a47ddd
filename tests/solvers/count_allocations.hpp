#pragma once

namespace slalom::testing {

/// Calls of `operator new` so far, in the whole program.
long allocations();

}  // namespace slalom::testing
