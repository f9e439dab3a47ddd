#pragma once

#include "slalom/core/random.hpp"
#include "slalom/sim/racing_line.hpp"
#include "slalom/sim/world.hpp"

namespace slalom::sim {

/// How an opponent drives.
enum class OpponentDriver {
  pursuit,  ///< pure pursuit of the path; it ignores everything else: PurePursuit
  racing,   ///< the racing line around parked bodies; it follows a car ahead and leaves room to one alongside
  blocking,  ///< follows the path and moves in front of a car that comes from behind
  erratic,   ///< follows the path and changes lane and speed at random times
};
inline const char* const* enum_names(OpponentDriver) {
  static constexpr const char* names[] = {"pursuit", "racing", "blocking", "erratic", nullptr};
  return names;
}

/// An opponent that drives a racing line among other cars, whose states it knows exactly. It steers by pure
/// pursuit (Coulter, CMU-RI-TR-92-01, 1992) from its rear axle and moves into another lane on a cubic curve,
/// within the room of the line. It keeps a distance behind a car in its lane, also behind one that stands.
/// While a car is alongside, from 0.15 m before they overlap along the line until 0.15 m after, it does not
/// move nearer to it than 0.1 m, as far as the line has room.
///
/// A blocking opponent moves to where the car is that is behind it within 4 m, at most 0.6 m from its line.
/// While a car is alongside it chooses no other lane. An erratic one draws a lane within 0.6 m, 60 to 100 %
/// of its speed, and 1 to 3 s to keep both, again and again. All lengths are for 1/10-scale cars.
class RacingOpponent {
 public:
  /// Drives car `car` of the worlds that it is given, which must have this car, at a share, [0.01, 1], of the
  /// speeds of the line. `driver` is not `pursuit`. Random numbers follow from `key`. Throws
  /// std::invalid_argument on a null line or a share out of range.
  RacingOpponent(std::shared_ptr<const RacingLine> line, std::size_t car, OpponentDriver driver,
                 double speed_share, RandomKey key);

  /// Returns steering and speed for now. Call it a few tens of times a second; the command holds meanwhile.
  Command command(const World& world);

  /// m left of the racing line, where the car wants to be since the last command.
  double lane() const noexcept { return lane_; }

 private:
  /// Another car as seen along the line.
  struct Neighbour {
    double gap = 0;                          ///< m along the line from the own middle to its middle
    double offset = 0;                       ///< m left of the path
    double half_length = 0, half_width = 0;  ///< m, along the line and across it
    double speed = 0;                        ///< m/s along the line
  };

  void look(const World& world);
  bool alongside(const Neighbour& other) const noexcept;
  double wanted_lane(double time);
  double offset_at(double ahead) const noexcept;
  double wanted_speed() const noexcept;

  std::shared_ptr<const RacingLine> line_;
  std::size_t car_;
  OpponentDriver driver_;
  double speed_share_;
  RandomStream random_;

  bool placed_ = false;
  LapPath::Place place_;                     ///< place of the own car along the path
  double speed_ = 0;                         ///< m/s, own
  double half_length_ = 0, half_width_ = 0;  ///< m, own
  std::vector<Neighbour> neighbours_;
  double lane_ = 0;    ///< m left of the line
  double change_ = 0;  ///< m, length of the way into the lane
  double random_lane_ = 0, random_share_ = 1,
         random_until_ = 0;  ///< choice of an erratic driver, and the time until which it holds
};

}  // namespace slalom::sim
