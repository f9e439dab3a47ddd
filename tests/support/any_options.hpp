#pragma once

#include <algorithm>

#include "slalom/core/options.hpp"
#include "support/adversary.hpp"

namespace slalom::testing {

/// Sets some options to any value in their ranges.
template <class Options>
void draw_options(Adversary& adversary, Options& options) {
  visit_options(options, [&]<class Field>(Field& field, const Declaration& declared) {
    if (!adversary.once_in(12)) return;
    const double least = std::max(declared.min, -1e12), most = std::min(declared.max, 1e12);
    const double drawn = adversary.once_in(3) ? (adversary.below(2) ? least : most)
                         : least > 0          ? least * std::pow(most / least, adversary.within(0, 1))
                                              : adversary.within(least, most);
    if constexpr (std::is_same_v<Field, bool>) {
      field = adversary.below(2) != 0;
    } else if constexpr (std::is_same_v<Field, double> || std::is_same_v<Field, int>) {
      field = static_cast<Field>(drawn);
    }
  });
}

}  // namespace slalom::testing
