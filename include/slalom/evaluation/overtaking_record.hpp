#pragma once

#include <vector>

namespace slalom::evaluation {

/// How an encounter with an opponent ended.
enum class EncounterEnd {
  open,          ///< the lap ended before
  overtaken,     ///< the car is ahead of the opponent, by 1 m from middle to middle
  not_overtaken  ///< after two times around the course, or at the timeout of the lap, it was not
};
/// The name of an end in results.
constexpr const char* name(EncounterEnd end) noexcept {
  return end == EncounterEnd::overtaken ? "overtaken" : end == EncounterEnd::open ? "open" : "not_overtaken";
}

/// An opponent met: from when the car is 1 to 4 m behind it along the course, from middle to middle.
struct Encounter {
  int opponent = 0;                       ///< from 0, in the order of LapSettings::opponent_speed
  double time = 0;                        ///< s, when it was met
  double duration = 0;                    ///< s, until it ended
  EncounterEnd end = EncounterEnd::open;  ///< reason why it ended
  int contacts = 0;                       ///< contacts with this opponent while it lasted
  int caused = 0;                         ///< contacts at which the car is at fault
  /// The number of times that the car has moved from one side of the opponent to the other while it was
  /// between 4 m behind and 1 m ahead. It is on a side if it is a car's width or more to the left or right,
  /// from middle to middle; between, it is still on the side on which it was.
  int side_changes = 0;
};

/// The opponents of a lap. A contact begins where the cars collide and have not collided for 0.5 s.
///
/// At fault is the car behind, unless it is alongside: its front axle is past the rear axle of the other.
/// Then it is the car that moves towards the other faster, across the course. Both are judged 0.05 to 0.1 s
/// before the contact.
struct OvertakingRecord {
  std::vector<Encounter> encounters;  ///< encounters in order of time
  int contacts = 0;                   ///< contacts with opponents, in encounters or not
  int caused = 0;                     ///< contacts at which the car is at fault
};

}  // namespace slalom::evaluation
