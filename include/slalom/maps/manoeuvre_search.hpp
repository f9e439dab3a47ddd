#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/body_room.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::maps {

/// The motions of a vehicle in a ManoeuvreSearch, their prices, and where it may end. Costs are in m of
/// driving forward with room.
struct ManoeuvreOptions {
  double radius = 0;        ///< m, least of an arc; 0: the vehicle turns on the spot, and
  double bend = 0;          ///< m, radius of its arcs; 0: none
  bool can_reverse = true;  ///< whether it drives backward
  double step = 0;          ///< m of an arc; cells have two thirds of it
  double cautious = 0;      ///< m of room below which driving costs up to five times as much
  double cusp_price = 0;    ///< m, of a change between forward and backward
  double turn_price = 0;    ///< m, of a turn on the spot by 1 rad
  double beside = 0;        ///< m from a goal to its side, and
  double turned = 0;        ///< rad from it, at which a way may end; with 0 it ends exactly at the goal
  double rear = 0;          ///< m, from the pose to the middle of the body's rear

  /// For a body of this length (m): 0.15 m steps for that of a 1/10-scale car, 0.58 m.
  static ManoeuvreOptions of(double length, double radius);
};

/// A pose at which a way may end.
struct ManoeuvreGoal {
  Pose pose;         ///< m, rad, relative to the start
  double price = 0;  ///< m, of what is then left to drive
};

/// Searches a way that may change between forward and reverse: to turn round, out of a corner, into a pose.
///
/// The search is Dijkstra's over cells of position and heading, 56 x 56 x 36 around the start, each with the
/// pose that reached it first (hybrid-state A* without a heuristic; Dolgov et al., "Path planning for
/// autonomous vehicles in unknown semi-structured environments", IJRR 29(5), 2010). A way to an exact pose
/// ends with the words C S C and C|C|C of J. Reeds and L. Shepp, "Optimal paths for a car that goes both
/// forwards and backwards", Pacific Journal of Mathematics 145 (1990). After construction nothing allocates.
class ManoeuvreSearch {
 public:
  static constexpr std::size_t max_steps = 256;   ///< most arcs of a way
  static constexpr std::size_t max_poses = 2048;  ///< most poses of it

  /// Allocates all that it needs.
  explicit ManoeuvreSearch(const ManoeuvreOptions& options);

  /// Searches a way from the pose (0, 0, 0) to one of the goals. All poses are relative to the start. Beyond
  /// `sight` (rad from the axis of the vehicle at the start) reversing costs eight times as much, as no
  /// sensor looks there. Returns whether there is a way.
  bool search(const BodyRoom& room, std::span<const ManoeuvreGoal> goals,
              double sight = std::numbers::pi) noexcept;
  /// The poses of the last way that was found, from the start on, at most a quarter of a step apart; each has
  /// the yaw of the vehicle.
  std::span<const Pose> poses() const noexcept { return poses_; }
  /// The goal at which it ends.
  std::size_t goal() const noexcept { return goal_; }
  const ManoeuvreOptions& options() const noexcept { return options_; }  ///< those of the constructor

 private:
  /// A drive with wheels held, or a turn on the spot.
  struct Arc {
    double length = 0;  ///< m, negative in reverse
    double turn = 0;    ///< rad, to the left
  };
  /// An arc of the search, and the poses in its middle and at its end, relative to its start.
  struct Move {
    Arc arc;
    Pose middle{}, end{};
  };
  struct Word {
    Arc arcs[3];
    double cost = std::numeric_limits<double>::infinity();
  };
  /// A pose, and how it was reached.
  struct Node {
    float x = 0, y = 0, yaw = 0;
    std::int32_t before = -1;
    std::int8_t arc = -1;
  };
  struct Reached {
    float cost;
    std::int32_t node;
    bool operator<(const Reached& other) const noexcept { return cost > other.cost; }
  };

  static Pose after(const Pose& from, const Arc& arc, double share = 1) noexcept;
  int index(const Pose& pose) const noexcept;
  double cost_of(const Word& word) const noexcept;
  bool is_free(const BodyRoom& room, const Pose& from, const Word& word) noexcept;
  void visit_words(const Pose& to, const auto& visit) const noexcept;
  bool ends_at(const BodyRoom& room, const Node& node, std::span<const ManoeuvreGoal> goals) noexcept;
  std::optional<Word> last_word(const BodyRoom& room, const Node& node,
                                std::span<const ManoeuvreGoal> goals) noexcept;
  void expand(const BodyRoom& room, const Reached& from, std::int8_t number, const Pose& middle,
              const Pose& there) noexcept;
  void push(int to, float cost, const Node& node) noexcept;
  bool take(std::int32_t node, const Word& word) noexcept;

  ManoeuvreOptions options_;
  std::vector<Move> moves_;
  std::vector<Node> nodes_;
  std::vector<float> costs_;  ///< the least cost of each node so far; infinite before the first
  ReservedVector<Reached> queue_;
  ReservedVector<Arc> chain_;
  ReservedVector<Pose> poses_;
  std::size_t goal_ = 0;
  int checks_ = 0;  ///< poses that the search has checked
  double cosine_of_sight_ = -1;
  double start_room_ = 0;  ///< m
};

}  // namespace slalom::maps
