#pragma once

#include <stdexcept>
#include <string>

namespace slalom::testing {

/// A promise was broken.
struct Finding : std::logic_error {
  using std::logic_error::logic_error;
};

/// A call took longer than it may.
struct SlowCall : Finding {
  using Finding::Finding;
};

/// The result of `call`. Other programs slow down a shared machine, so that a slow call is repeated, and is a
/// finding only if it is slow three times.
template <class Call>
auto repeat_if_slow(const Call& call) {
  for (int attempt = 1;; ++attempt) {
    try {
      return call();
    } catch (const SlowCall&) {
      if (attempt == 3) throw;
    }
  }
}

/// Throws Finding unless `holds`: for properties that tests and fuzz targets share.
inline void require(bool holds, const std::string& promise) {
  if (!holds) throw Finding(promise);
}

}  // namespace slalom::testing
