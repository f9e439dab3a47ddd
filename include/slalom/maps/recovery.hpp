#pragma once

#include <limits>

namespace slalom::maps {

/// How a vehicle gets on along its way. In every state it stands for a limited time only, and then goes on to
/// the next state (`Recovery::standing_limit`).
enum class DriveState {
  following,    ///< drives along its way
  waiting,      ///< something that may go away is in its way
  reversing,    ///< drives back from a place where it did not get on
  manoeuvring,  ///< drives the legs of a manoeuvre
  retrying,     ///< drives on by another way, until it is past that place
  stuck         ///< has tried several times without getting on
};

/// Lengths, speeds and times of a Recovery.
struct RecoveryLengths {
  double progress = 0;       ///< m along the way that count as progress
  double relief = 0;         ///< m past the place of trouble, after which it is over
  double shortest = 0;       ///< m to reverse at first; each further time 1.6 times as far
  double longest = 0;        ///< m to reverse at most; 0: the vehicle tries another way instead of reversing
  double jump = 0;           ///< m along the way, in which a vehicle was put somewhere else
  double standing = 0;       ///< m/s, a slower vehicle stands
  double reverse = 0;        ///< m/s, highest speed in reverse
  double stand_still = 0.7;  ///< s of standing, after which it does something else
  double patience = 3;       ///< s without progress, after which it does something else
  double wait = 20;          ///< s for which it waits, for a manoeuvre to begin, or after all attempts
  int attempts = std::numeric_limits<int>::max();  ///< times without progress until it is stuck

  /// For a body of this length (m). Lengths grow with it, and speeds with its root, so that the accelerations
  /// stay the same. A 1/10-scale car, 0.58 m long, reverses for 0.8 to 3 m at 0.45 m/s. That is slow since a
  /// reversing car steers with its rear: the car of f1tenth_gym diverges above 0.5 m/s.
  static RecoveryLengths of(double body_length) noexcept;
};

/// Decides how a vehicle gets on: a state machine over DriveState.
class Recovery {
 public:
  /// The vehicle in a control period.
  struct Seen {
    double arc = 0;            ///< m along its way
    double speed = 0;          ///< m/s, negative in reverse
    double free_speed = 0;     ///< m/s, that it would drive if the way were free
    double closed_length = 0;  ///< m, of a closed way; 0 if it is open
    bool waits = false;        ///< something that may go away is in its way
    bool is_free = false;      ///< it can drive on, so that half of a way in reverse is enough
  };
  /// The next state of a vehicle that stands.
  struct StandingLimit {
    double time = 0;                          ///< s of standing in a state
    DriveState next = DriveState::following;  ///< the state after it
  };

  /// Begins in the state `following`.
  explicit Recovery(const RecoveryLengths& lengths) : lengths_(lengths), distance_(lengths.shortest) {}

  /// Advances by one control period (s).
  DriveState update(const Seen& seen, double period) noexcept;
  /// Begins to watch anew from this place (m), for instance on another way: nothing counts as standing.
  void watch_from(double arc) noexcept;
  /// The vehicle drives a manoeuvre until `end_manoeuvre`.
  void begin_manoeuvre() noexcept { enter(DriveState::manoeuvring); }
  /// The vehicle drives on after a manoeuvre to this place (m).
  void end_manoeuvre(double arc) noexcept;
  void reset() noexcept { *this = Recovery(lengths_); }  ///< begins anew

  DriveState state() const noexcept { return state_; }  ///< the present state
  /// Whether it began to do something else in the last update: to reverse, or to try another way.
  bool begins() const noexcept { return begins_; }
  /// Whether it reverses.
  bool reverses() const noexcept { return state_ == DriveState::reversing; }
  /// Whether it is not yet past the place where it crawled or stood.
  bool leaving() const noexcept { return leaving_; }
  /// Whether it has tried to get on by other means and is not yet past that place.
  bool retries() const noexcept { return retries_ && !reverses(); }
  /// The share of the margin around the body that plans keep: less where it was too near to obstacles even to
  /// reverse, until it is past that place. A vehicle whose margin just touches an obstacle finds no plan
  /// without a collision in either direction, though there is room.
  double margin_share() const noexcept { return confined_ ? 0.2 : 1; }
  /// How long it stands in a state, and what it does then.
  StandingLimit standing_limit(DriveState state) const noexcept;
  const RecoveryLengths& lengths() const noexcept { return lengths_; }  ///< those of the constructor

 private:
  void enter(DriveState state) noexcept;
  void watch(const Seen& seen, double period) noexcept;
  void note_progress(const Seen& seen, double period) noexcept;
  void reverse(const Seen& seen, double period) noexcept;
  void try_again(const Seen& seen) noexcept;

  RecoveryLengths lengths_;
  DriveState state_ = DriveState::following;
  bool started_ = false, begins_ = false, leaving_ = false, retries_ = false, confined_ = false;
  int attempts_ = 0;
  double furthest_ = 0, trouble_ = 0, tried_at_ = 0;  ///< m along the way
  double since_progress_ = 0, crawling_ = 0;          ///< s
  double standing_ = 0, in_state_ = 0;                ///< s
  double driven_ = 0, distance_;                      ///< m in reverse, and to reverse next time
};

}  // namespace slalom::maps
