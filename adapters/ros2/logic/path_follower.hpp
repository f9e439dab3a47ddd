#pragma once

#include <optional>

#include "logic/follower_settings.hpp"
#include "slalom/core/problem_parts.hpp"
#include "slalom/navigation/costmap.hpp"

/// The logic of a controller of nav2, without its transport.
namespace slalom::nodes {

/// The cells of a nav2_costmap_2d::Costmap2D, row by row, row 0 at the bottom: 0 to 252 free at a price, 253
/// free for a point but not for the middle of the robot, 254 an obstacle, 255 unknown. The footprint decides
/// what collides, so 253 counts as 252. `costs` must stay valid while it is used.
struct CostGrid {
  int width = 0, height = 0;             ///< cells
  double resolution = 0;                 ///< m
  double x = 0, y = 0;                   ///< m, lower left corner of the first cell
  const unsigned char* costs = nullptr;  ///< height x width
};

/// The tolerances of a goal checker; 0 where it tells nothing.
struct GoalTolerance {
  double distance = 0;  ///< m
  double angle = 0;     ///< rad; 0: the heading does not matter

  bool operator==(const GoalTolerance&) const = default;
};

/// The input of an update. All poses are in the frame of the costmap.
struct FollowerInput {
  maps::Pose pose;                         ///< pose of the robot
  navigation::Velocity velocity;           ///< measured velocity of the robot
  double time = 0;                         ///< s, of a clock
  maps::Pose plan_frame;                   ///< pose of the frame of the plan
  std::optional<GoalTolerance> tolerance;  ///< none: the options decide
};

/// The answer of an update.
struct FollowerAnswer {
  enum class Problem {
    none,          ///< there is a command
    invalid_path,  ///< there is no plan
    no_control,    ///< there is no command that makes sense; the robot should stop
  };
  Problem problem = Problem::none;
  std::string why{};               ///< the problem, for the user
  std::string_view status{};       ///< name of the navigator's status; empty before it ran
  navigation::Velocity command{};  ///< 0 unless there is a command; always finite and within the limits
  double remaining = 0;            ///< m of path to the goal
};

/// Follows plans. Options that mean the same as in nav2's MPPI controller have its names. Not thread-safe.
class PathFollower {
 public:
  /// Throws std::exception that lists the names if the method is unknown.
  explicit PathFollower(const std::string& method = "svg_mppi");

  std::vector<NamedOption> options() const { return settings_.list(); }
  /// Where it learns of people. A node then lets `people` see or hear them, in the frame of the costmap.
  OthersFrom others_from() const { return settings_.own().others; }
  OthersWatch& people() { return people_; }
  /// Whether a node should publish the plans.
  bool visualizes() const { return settings_.own().visualize; }
  /// The time (s) for which a node should wait for a transform.
  double transform_tolerance() const { return settings_.own().transform_tolerance; }
  /// Sets options; takes effect with the next update. Throws std::exception with name, value and rule.
  void change(const Changes& changes);

  /// Adds a term of one's own to the cost of plans.
  void add_cost(const std::string& name, navigation::StateCost cost);
  /// Takes the outline of the robot: its vertices in order. Throws std::exception with the rule unless they
  /// are a simple polygon of 3 to 32 vertices around the origin.
  void use_footprint(const std::vector<maps::Point>& vertices);
  /// Takes the cells of a costmap. Throws std::exception if the library takes no such size or resolution.
  void use_costmap(const CostGrid& grid);
  /// Takes a plan in its own frame, from near the robot to the goal. One that ends like the present one
  /// changes nothing (Navigator::set_path). Ends a cancellation. Throws std::exception unless there is at
  /// least one pose and all are finite.
  void use_plan(const std::vector<maps::Pose>& plan);
  /// Scales all speeds so that the largest is at most this: in percent of the limits, or an absolute speed
  /// forward (m/s). 0: no limit. Throws std::exception unless it is finite and at least 0.
  void limit_speed(double limit, bool percentage);

  /// Begins to brake. Returns true once the robot stands, or should.
  bool cancel();
  /// Forgets the plan and all that was learned on it. A speed limit stays.
  void reset();

  /// Returns the command for the next control period. Throws no std::exception.
  FollowerAnswer update(const FollowerInput& input);
  /// The poses of the last plan of the solver, frame of the costmap.
  const std::vector<maps::Pose>& predicted() const { return predicted_; }
  /// The parts of the cost of that plan by name, those of `add_cost` at the end; they sum to it. Empty where
  /// there is no plan. Allocates.
  std::vector<CostTerm> cost_terms() const;
  /// About `most` samples of that plan as lines from each point to the next, frame of the costmap: two points
  /// for each. Allocates.
  std::vector<maps::Point> samples(int most) const;
  /// The path that is followed, with the present detour; frame of the costmap.
  const std::vector<maps::Pose>& path() const { return path_; }

 private:
  void clear(std::span<const maps::PredictedObstacle> others);
  void make_navigator(const std::optional<GoalTolerance>& told);
  void place_plan(const maps::Pose& plan_frame);
  double elapsed_until(double time);
  FollowerAnswer judge(const navigation::NavigationResult& result, double elapsed);
  std::uint64_t seed() const;
  void find_share();

  FollowerSettings settings_;
  std::vector<std::pair<std::string, navigation::StateCost>> own_costs_;
  std::optional<navigation::Footprint> footprint_;
  std::vector<maps::Point> vertices_;  ///< vertices of the footprint
  maps::OccupancyGrid grid_;
  std::vector<float> prices_;  ///< prices of the cells
  std::optional<navigation::Costmap> costmap_;
  OthersWatch people_;
  std::optional<navigation::Navigator> navigator_;  ///< none: the next update makes it
  std::optional<GoalTolerance> tolerance_;          ///< tolerance of that navigator
  std::vector<maps::Pose> plan_;                    ///< in its own frame
  std::optional<maps::Pose> placed_frame_;          ///< where that frame was when the navigator took the plan
  double remaining_ = 0;                            ///< m of the plan that were left in the last update
  double limit_ = 0;                                ///< m/s or percent; 0: none
  bool limit_is_percentage_ = false;
  double share_ = 1;  ///< share of the limits of the base that the limit leaves

  std::optional<double> last_time_;          ///< s, of the last update
  navigation::Velocity velocity_, command_;  ///< velocity and command of the last update
  bool cancelling_ = false;
  double cancelling_for_ = 0;  ///< s
  std::vector<maps::Pose> predicted_, path_;
};

}  // namespace slalom::nodes
