#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slalom/sim/world.hpp"

namespace slalom::sim {

/// The inputs of a run: start and commands. Replayed in a world with the same options and track, it gives the
/// same states, scans and collisions bit for bit. Bodies that were placed after the reset are not recorded.
struct Recording {
  std::uint64_t seed = 0;            ///< seed of the random numbers
  std::vector<maps::Pose> cars{};    ///< start poses of the cars
  std::vector<maps::Pose> parked{};  ///< poses of the parked cars
  std::vector<Command> commands{};   ///< steps x cars

  /// Resets the world to the recording's start and forgets recorded commands.
  void begin(World& world);

  /// Steps the world and keeps the commands, one per car. Throws std::invalid_argument on another number.
  StepStatus step(World& world, std::span<const Command> step_commands);

  /// Runs all complete steps of the recording.
  void replay(World& world) const;

  /// The complete steps as lines of text; numbers keep all their bits.
  std::string to_text() const;
  /// Throws std::invalid_argument naming the line that is wrong.
  static Recording from_text(std::string_view text);
};

}  // namespace slalom::sim
