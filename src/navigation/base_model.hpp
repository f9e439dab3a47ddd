#pragma once

#include "slalom/navigation/navigation_problem.hpp"
#include "slalom/navigation/navigator.hpp"

namespace slalom::navigation::detail {

/// A controller of a navigation problem, whatever the base.
class BaseModel {
 public:
  virtual ~BaseModel() = default;
  virtual std::unique_ptr<BaseModel> clone() const = 0;
  /// Solves from a pose (map frame) with the velocity of now; `elapsed` s after the last solve.
  virtual void solve(const NavigationMaps& maps, const maps::Pose& pose, const Velocity& velocity,
                     double elapsed) noexcept = 0;
  /// The velocity of the plan's first step, and the poses that it predicts, map frame.
  virtual const Velocity& command() const noexcept = 0;
  virtual std::span<const maps::Pose> plan() const noexcept = 0;
  virtual const SolveResult& solution() const noexcept = 0;
  virtual Trajectories roll_out(std::span<const float> sequences) const = 0;  ///< as Navigator::roll_out
  virtual void reset(std::uint64_t seed) noexcept = 0;
  virtual void set_cost(StateCost cost) noexcept = 0;
};

/// For the base of the options. Throws std::invalid_argument as Controller does.
std::unique_ptr<BaseModel> make_base_model(const NavigatorOptions& options, const Footprint& footprint,
                                           double resolution, const SolverOptions& solver);

}  // namespace slalom::navigation::detail
