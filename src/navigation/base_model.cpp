#include "navigation/base_model.hpp"

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "navigation/navigation_evaluator.hpp"
#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/trajectories.hpp"

namespace slalom::navigation::detail {

namespace {

template <class Base>
class BaseModelOf final : public BaseModel {
 public:
  BaseModelOf(const NavigatorOptions& options, const Footprint& footprint, double resolution,
              const SolverOptions& solver)
      : controller_(NavigationEvaluator<Base>(NavigationProblem<Base>(options.base, options.costs, footprint,
                                                                      resolution, options.time_step)),
                    solver),
        plan_(static_cast<std::size_t>(controller_.solver().horizon()) + 1) {}
  std::unique_ptr<BaseModel> clone() const override { return std::make_unique<BaseModelOf>(*this); }

  void solve(const NavigationMaps& maps, const maps::Pose& pose, const Velocity& velocity,
             double elapsed) noexcept override {
    controller_.evaluator().set_maps(maps);
    origin_ = maps.origin;
    Input<double, Base::inputs> before = Base::input(velocity);
    for (int i = 0; i < Base::inputs; ++i) {
      const auto at = static_cast<std::size_t>(i);
      before[i] = std::clamp(before[i], controller_.bounds().low[at], controller_.bounds().high[at]);
    }
    const auto plan =
        controller_.solve({pose.x - maps.origin.x, pose.y - maps.origin.y, pose.yaw, maps.progress, before},
                          {.elapsed = elapsed});
    const Motion<double> motion = controller_.problem().motion(plan.states[1].before);
    command_ = {motion.forward, motion.left, motion.turn};
    for (std::size_t i = 0; i < plan_.size(); ++i)
      plan_[i] = {plan.states[i].x + maps.origin.x, plan.states[i].y + maps.origin.y, plan.states[i].yaw};
  }
  const Velocity& command() const noexcept override { return command_; }
  std::span<const maps::Pose> plan() const noexcept override { return plan_; }
  const SolveResult& solution() const noexcept override { return controller_.solver().result(); }
  Trajectories roll_out(std::span<const float> sequences) const override {
    Trajectories all = controller_.evaluator().roll_out(sequences, controller_.solver().horizon());
    constexpr std::size_t size = sizeof(State) / sizeof(double);
    std::vector<double> states;
    for (std::size_t at = 0; at < all.states.size(); at += size) {
      State x;
      std::memcpy(&x, &all.states[at], sizeof x);
      const Motion<double> motion = controller_.problem().motion(x.before);
      states.insert(states.end(),
                    {x.x + origin_.x, x.y + origin_.y, x.yaw, motion.forward, motion.left, motion.turn});
    }
    all.states = std::move(states);
    return all;
  }
  void reset(std::uint64_t seed) noexcept override { controller_.reset(seed); }
  void set_cost(StateCost cost) noexcept override { controller_.evaluator().set_cost(std::move(cost)); }

 private:
  using State = typename NavigationEvaluator<Base>::State;

  Controller<NavigationEvaluator<Base>> controller_;
  maps::Point origin_;  ///< m, map frame, where the states of the last plan begin
  Velocity command_;
  std::vector<maps::Pose> plan_;
};

}  // namespace

std::unique_ptr<BaseModel> make_base_model(const NavigatorOptions& options, const Footprint& footprint,
                                           double resolution, const SolverOptions& solver) {
  switch (options.base.kind) {
    case BaseKind::omnidirectional:
      return std::make_unique<BaseModelOf<OmnidirectionalBase>>(options, footprint, resolution, solver);
    case BaseKind::ackermann:
      return std::make_unique<BaseModelOf<AckermannBase>>(options, footprint, resolution, solver);
    case BaseKind::differential:
      break;
  }
  return std::make_unique<BaseModelOf<DifferentialBase>>(options, footprint, resolution, solver);
}

}  // namespace slalom::navigation::detail
