#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include "view/server/server.hpp"
#include "view/session/scenario.hpp"
#include "view/session/simulation.hpp"

namespace slalom::view {

/// Most ticks that a turn of the session drives again, for all clients together.
inline constexpr int max_redriven_ticks = 8;

/// How many ticks one turn may still drive again: at least two, so that a copy catches up with a drive that
/// makes one tick a turn, and at most `max_redriven_ticks`, of which none begins after 10 ms.
class RedriveBudget {
 public:
  /// Whether a tick may be driven, which is then counted.
  bool take();
  int taken() const noexcept { return taken_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point end_ = Clock::now() + std::chrono::milliseconds(10);
  int taken_ = 0;
};

/// The search for a collision in a lap of an evaluation, and the state a while before it.
class ContactSearch {
 public:
  /// `contact`: the index of the collision among the first collisions with each body. `lead`: s before the
  /// collision at which `start` ends.
  ContactSearch(const evaluation::LapSetup& setup, std::uint64_t seed, int contact, double lead);

  /// Drives as far as the budget allows. True once `start` and `hit` are there. Throws std::runtime_error if
  /// the lap ends without the collision.
  bool advance(RedriveBudget& budget);

  int hit() const noexcept { return hit_; }  ///< tick of the collision
  Simulation& start() noexcept { return *start_; }

 private:
  int contact_;
  double lead_;
  Simulation lap_;
  int hit_ = -1;
  std::optional<Simulation> start_;
};

/// A command that waits until what it needs has been driven again: the state at the tick that was shown when
/// it came, a copy of the drive for a ghost, or a lap of an evaluation.
struct Redrive {
  Received received;    ///< the command
  int view = -1;        ///< tick that was shown, to which the command goes back; -1: it does not go back
  bool copies = false;  ///< whether the command needs a copy of the drive
  bool is_lap = false;  ///< whether the command shows a collision in a lap

  // What has been driven for it.
  std::optional<Simulation> present{};  ///< of the car, towards the tick after `view`
  std::optional<Simulation> ghost{};    ///< of the ghost, likewise
  std::optional<Simulation>
      copy{};  ///< for the new ghost, towards the state from which the command continues
  std::optional<LoadedLap> lap{};
  std::optional<ContactSearch> search{};

  /// Drives as far as the budget allows. True once everything is there. `ghost_now` is null where there is no
  /// ghost.
  bool advance(const Simulation& drive, const Simulation* ghost_now, RedriveBudget& budget);
  /// The drive went back to the state before tick `ticks`: what was driven beyond it, and a view of it, no
  /// longer hold.
  void go_back(int ticks);
  /// Another drive has begun: what was driven no longer holds.
  void begin_anew();
};

}  // namespace slalom::view
