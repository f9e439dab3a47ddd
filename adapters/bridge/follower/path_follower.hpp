#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/bridge.hpp"

/// What a controller of nav2 does, without its transport: it drives a mobile robot along a plan to a goal,
/// between the obstacles of a costmap.
namespace slalom_bridge {

/// A velocity in the robot's frame.
struct Velocity {
  double forward = 0, left = 0;  ///< m/s
  double turn = 0;               ///< rad/s, counter-clockwise
};

/// The cells of a nav2_costmap_2d::Costmap2D, row by row, row 0 at the bottom: 0 to 252 free, 253 free for a
/// point but not for the middle of the robot, 254 an obstacle, 255 unknown. The footprint decides what
/// collides, so 253 counts as free. `costs` must stay valid while it is used.
struct CostGrid {
  int width = 0, height = 0;             ///< cells
  double resolution = 0;                 ///< m
  double x = 0, y = 0;                   ///< m, lower left corner of the first cell
  const unsigned char* costs = nullptr;  ///< height x width
};

/// How near to the goal the robot must come, as a goal checker tells it; 0 where it tells nothing.
struct GoalTolerance {
  double distance = 0;  ///< m
  double angle = 0;     ///< rad; 0: the heading does not matter
  bool known = false;   ///< whether a goal checker told these; otherwise the options decide
};

/// The input of an update. All poses are in the frame of the costmap.
struct FollowerInput {
  Pose pose;          ///< of the robot
  Velocity velocity;  ///< of the robot, as measured
  double time = 0;    ///< s, of a clock
  Pose plan_frame;    ///< of the frame of the plan
  GoalTolerance tolerance;
};

/// The answer of an update.
struct FollowerAnswer {
  enum class Problem {
    none,          ///< there is a command
    invalid_path,  ///< there is no plan
    no_control,    ///< there is no command that makes sense; the robot should stop
  };
  Problem problem = Problem::none;
  std::string why;          ///< what the problem is, for the user
  std::string_view status;  ///< name of the navigator's status, valid for the whole run; empty before it ran
  Velocity command;         ///< 0 unless there is a command; always finite and within the limits
  double remaining = 0;     ///< m of path to the goal
};

/// Follows plans. The options have the names of nav2's MPPI controller where they mean the same. Of its
/// functions one at a time may run.
class PathFollower {
 public:
  /// Throws std::exception that lists the names if the method is unknown.
  explicit PathFollower(const std::string& method = "svg_mppi");
  ~PathFollower();

  std::vector<Option> options() const;  ///< "option" or "section/option"
  bool visualizes() const;              ///< whether a node should publish what is planned and followed
  double transform_tolerance() const;   ///< s, for which a node should wait for a transform
  void change(const Changes& changes);  ///< sets options; takes effect with the next update

  /// The outline of the robot: vertices in order, of which only x and y are used. Throws std::exception with
  /// the rule unless they are a simple polygon of 3 to 32 vertices around the origin.
  void use_footprint(const std::vector<Pose>& vertices);
  /// Takes the cells of a costmap. Throws std::exception with the rule if its size or resolution is none that
  /// the library takes.
  void use_costmap(const CostGrid& grid);
  /// A plan in its own frame, from near the robot to the goal. A plan that leads along the present one to the
  /// same goal changes nothing, so that a detour is kept. Ends a cancellation. Throws std::exception unless
  /// there is at least one pose and all are finite.
  void use_plan(const std::vector<Pose>& plan, const std::string& frame);
  /// All speeds are scaled so that the largest is at most this: in percent of the limits, or an absolute
  /// speed forward (m/s). 0: no limit. Throws std::exception unless it is finite and at least 0.
  void limit_speed(double limit, bool percentage);

  /// Begins to brake. Returns true once the robot stands, or should.
  bool cancel();
  /// Forgets the plan and all that was learned on it. A speed limit stays.
  void reset();

  /// The command for the next control period. Throws no std::exception.
  FollowerAnswer update(const FollowerInput& input);
  std::vector<Pose> predicted() const;  ///< poses of the last plan of the solver, frame of the costmap
  std::vector<Pose> path() const;       ///< what is followed, with the present detour; the same frame

 private:
  struct Hidden;
  std::unique_ptr<Hidden> hidden_;
};

}  // namespace slalom_bridge
