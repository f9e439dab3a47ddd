#include "slalom/sim/script.hpp"

#include <algorithm>

#include "sim/validation.hpp"

namespace slalom::sim {

Script::Script(std::vector<Line> lines) : lines_(std::move(lines)) {
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    detail::require_finite("script time", lines_[i].from);
    detail::require_finite("script: steer", lines_[i].command.steer);
    detail::require_finite("script: speed", lines_[i].command.speed);
    if (i > 0 && !(lines_[i].from > lines_[i - 1].from))
      detail::fail("script time", std::to_string(lines_[i].from), "after that of the line before");
  }
}

Command Script::command(double time) const noexcept {
  const auto after = std::upper_bound(lines_.begin(), lines_.end(), time,
                                      [](double t, const Line& line) { return t < line.from; });
  return after == lines_.begin() ? Command{} : (after - 1)->command;
}

}  // namespace slalom::sim
