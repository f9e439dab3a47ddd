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

/// Throws Finding unless `holds`: for properties that tests and fuzz targets share.
inline void require(bool holds, const std::string& promise) {
  if (!holds) throw Finding(promise);
}

}  // namespace slalom::testing
