#pragma once

#include <vector>

#include "slalom/sim/plant.hpp"

namespace slalom::sim {

/// A driver without feedback: a fixed sequence of commands by time.
class Script {
 public:
  /// A command and the time from which it holds.
  struct Line {
    double from = 0;  ///< s, this command holds from here to the next line
    Command command;  ///< the command
  };

  /// Throws std::invalid_argument on times or commands that are not finite, or times that do not rise.
  explicit Script(std::vector<Line> lines);

  /// The command at a time (s); zero before the first line.
  Command command(double time) const noexcept;

 private:
  std::vector<Line> lines_;
};

}  // namespace slalom::sim
