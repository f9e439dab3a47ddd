#pragma once

#include <algorithm>
#include <cmath>

#include "slalom/navigation/navigator.hpp"

namespace slalom::navigation::detail {

/// The last thing that happens to a result before it leaves the navigator: makes the command finite and moves
/// it into the limits of the base. Counts what it changed in `corrections`.
inline void check_result(NavigationResult& result, const BaseOptions& base) noexcept {
  const auto check = [&](double& value, double least, double most) {
    const double valid = std::clamp(std::isfinite(value) ? value : 0.0, least, most);
    result.corrections += valid != value;
    value = valid;
  };
  const double sideways = base.kind == BaseKind::omnidirectional ? base.max_sideways : 0;
  check(result.command.forward, -base.max_reverse, base.max_forward);
  check(result.command.left, -sideways, sideways);
  check(result.command.turn, -base.max_turn, base.max_turn);
}

}  // namespace slalom::navigation::detail
