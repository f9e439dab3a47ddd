#include <algorithm>
#include <iterator>
#include <string_view>

#include "view/session/session.hpp"

namespace slalom::view {

/// The introduction is in slow motion until the obstacle has been passed.
void Session::slow_down() {
  if (!introduces_ || slow_motion_.is_over()) return;
  const double rate =
      slow_motion_.rate({&simulation_->loop().world(), ghost_ ? &ghost_->loop().world() : nullptr});
  if (rate == rate_) return;
  rate_ = rate;
  state_changed_ = true;
}

/// After these commands another scenario or another rate is driven.
void Session::end_introduction(const std::string& command) {
  constexpr std::string_view drives[] = {"scenario", "method", "fork",         "ghost",
                                         "set",      "preset", "reset_options"};
  constexpr std::string_view paces[] = {"rate", "real_time", "lap"};
  const auto is_among = [&](const auto& names) {
    return std::find(std::begin(names), std::end(names), command) != std::end(names);
  };
  if (!introduces_ || !(is_among(drives) || is_among(paces))) return;
  introduces_ = false;
  if (is_among(drives)) rate_ = 1;
}

}  // namespace slalom::view
