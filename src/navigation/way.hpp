#pragma once

#include "navigation/approach.hpp"
#include "navigation/others.hpp"
#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/leg_follower.hpp"
#include "slalom/maps/recovery.hpp"
#include "slalom/navigation/navigator.hpp"
#include "slalom/navigation/path_planner.hpp"

namespace slalom::navigation::detail {

/// The path that the robot follows, with detours where it is blocked, and the progress on it.
class Way {
 public:
  /// For costmaps of this size, and plans that reach so far (m).
  Way(const NavigatorOptions& options, const Footprint& footprint, const maps::GridGeometry& geometry,
      double reach);

  void set_path(std::span<const maps::Pose> path);  ///< as Navigator::set_path
  void clear() noexcept;
  bool empty() const noexcept { return guide_.empty() && waiting_.empty(); }

  /// Moves on along the path.
  void advance(const maps::Pose& robot, const Velocity& velocity, const Costmap& costmap,
               double elapsed) noexcept;
  /// Keeps the path ahead open. Returns false if there has been no way for longer than patience.
  bool keep(const maps::Pose& robot, const Costmap& costmap, const Others& others, double elapsed) noexcept;

  /// Whether the robot is at the end of the path, within the tolerances. Then the same path may be set again.
  bool has_ended(const maps::Pose& robot) noexcept { return is_done_ = ends_at(robot); }
  /// Whether a robot there would be.
  bool ends_at(const maps::Pose& robot) const noexcept { return later_.empty() && stops_at(robot); }
  /// Whether the robot has made no progress for so long that it stands for a while before it tries again.
  bool is_stuck() const noexcept { return recovery_.state() == maps::DriveState::stuck; }
  /// Whether it has stood for so long that it tries another way, or would if it did not wait for somebody.
  bool stands() const noexcept { return standing_ >= recovery_.lengths().stand_still; }
  bool is_detour() const noexcept { return guide_.remaining() > detour_left_; }
  /// Whether the robot has come as near to an occupied goal as it may.
  bool is_at_stop() const noexcept {
    return stop_ != no_stop && guide_.nearest() + guide_.points_for(options_.goal_distance) >= stop_;
  }

  double remaining() const noexcept { return guide_.remaining() + later_length_; }  ///< m
  std::span<const maps::Pose> points() const noexcept { return guide_.points(); }   ///< the path
  /// Sets the part of the path around the robot in `maps`.
  void write(const maps::Pose& robot, NavigationMaps& maps) noexcept {
    guide_.write(robot, legs_.turn_left(), stop_, maps);
    maps.manoeuvres = approach_.manoeuvres(guide_.remaining());
  }

 private:
  std::size_t first_closed(const Costmap& costmap, std::size_t first, double length) const noexcept;
  bool is_closed(const Costmap& costmap, std::size_t point) const noexcept;
  bool stops_at(const maps::Pose& robot) const noexcept;
  void take_up() noexcept;
  void forget_tries() noexcept;
  void make_room_for_turn(const Costmap& costmap) noexcept;
  bool is_followed(const maps::PathCurve& path, std::span<const double> stops) const;
  bool is_goal(const maps::Pose& pose) const noexcept;
  void follow(std::span<const maps::Pose> path, double smooth = 0) noexcept;
  /// A place where a detour joins the path again.
  struct Joint {
    std::size_t point;     ///< index in the path; its number of points if there is none
    maps::Point end{};     ///< m, of the way over the costmap
    double cost;           ///< m, with the rest of the path
    bool not_yet = false;  ///< whether a search that goes on may find a cheaper one
  };
  bool find_way(const maps::Pose& pose, const Costmap& costmap, std::size_t closed, double most) noexcept;
  Joint cheapest_joint(const Costmap& costmap, std::size_t closed, std::size_t usual,
                       double most) const noexcept;
  bool take_detour(const Joint& joint) noexcept;
  void avoid_meeting(const maps::Pose& pose, const Costmap& costmap, const Others& others) noexcept;
  bool waits_at_goal(const Costmap& costmap, std::size_t closed) noexcept;
  void watch_progress(const maps::Pose& robot, const Costmap& costmap, const Others& others,
                      double elapsed) noexcept;
  void try_another_way(const maps::Pose& robot, const Costmap& costmap) noexcept;

  static constexpr double infinity = std::numeric_limits<double>::infinity();

  NavigatorOptions options_;
  Footprint footprint_, inner_;  ///< the body, and without a rim of a cell
  PathGuide guide_;
  PathPlanner planner_;
  Approach approach_;
  maps::LegFollower legs_;
  maps::Recovery recovery_;
  maps::PathCurve given_;               ///< the path that was set
  std::vector<double> given_stops_;     ///< rad, the yaws that are asked for on its way
  ReservedVector<maps::Pose> later_;    ///< the path from the next of these on; empty if there is none
  double later_length_ = 0;             ///< m
  ReservedVector<maps::Pose> poses_;    ///< a path that is being made
  ReservedVector<maps::Pose> waiting_;  ///< a new path, which the next update takes up, or
  bool waits_ = false;                  ///< only at the end of the present manoeuvre, to the same goal
  ReservedVector<maps::Pose> chosen_;   ///< the last detour, which later searches prefer
  maps::ClosedDiscs closed_;
  double detour_left_ = infinity;  ///< m of path left where the detour ends
  double without_way_ = 0;         ///< s since the path is blocked and no way round was found
  int searched_ = 0;               ///< updates of the last search, less those in which it has rested since
  bool is_new_ = true;             ///< the next update places the robot on the path
  std::size_t count_ = 0;          ///< points of the path at the last look for progress
  double left_ = 0, other_ = 0;    ///< m left of the path then; m by which it was longer than the first
  bool is_done_ = false;           ///< whether the end was reached
  double speed_ = 0;               ///< m/s, of the robot; in a turn, too
  maps::Pose stood_at_;            ///< near which it has been
  double standing_ = 0;            ///< for so long, s
  maps::Point position_;           ///< m, of the robot
  bool manoeuvres_ = false;        ///< whether a manoeuvre was the last try to get on
  std::size_t stop_ = no_stop;     ///< point of the path before an occupied goal
  std::size_t checked_ = no_stop;  ///< point of the last turn whose room was checked
};

}  // namespace slalom::navigation::detail
