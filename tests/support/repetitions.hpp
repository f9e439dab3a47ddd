#pragma once

#include <cstdlib>

namespace slalom::testing {

/// How often a property is tried: the environment's SLALOM_CALLS, or `otherwise`.
inline long repetitions(long otherwise) {
  const char* set = std::getenv("SLALOM_CALLS");
  return set ? std::strtol(set, nullptr, 10) : otherwise;
}

}  // namespace slalom::testing
