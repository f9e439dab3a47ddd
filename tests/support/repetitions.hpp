#pragma once

#include <cstdint>
#include <cstdlib>

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

}  // namespace slalom::testing
