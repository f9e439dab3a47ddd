#include "navigation/base_model.hpp"

#include <vector>

#include "slalom/solvers/controller.hpp"

namespace slalom::navigation::detail {

namespace {

template <class Base>
class BaseModelOf final : public BaseModel {
 public:
  BaseModelOf(const NavigatorOptions& options, const Footprint& footprint, double resolution,
              const SolverOptions& solver)
      : base_(options.base),
        controller_(
            NavigationProblem<Base>(options.base, options.costs, footprint, resolution, options.time_step),
            solver),
        plan_(static_cast<std::size_t>(controller_.solver().horizon()) + 1) {}
  std::unique_ptr<BaseModel> clone() const override { return std::make_unique<BaseModelOf>(*this); }

  void solve(const NavigationMaps& maps, const maps::Pose& pose, const Velocity& velocity,
             double elapsed) noexcept override {
    controller_.problem().set_maps(maps);
    controller_.set_previous_input(Base::input(velocity));
    const auto plan = controller_.solve(
        {pose.x - maps.origin.x, pose.y - maps.origin.y, pose.yaw, maps.progress}, {.elapsed = elapsed});
    const Motion<double> motion = base_.template motion<double>(plan.inputs[0]);
    command_ = {motion.forward, motion.left, motion.turn};
    for (std::size_t i = 0; i < plan_.size(); ++i)
      plan_[i] = {plan.states[i].x + maps.origin.x, plan.states[i].y + maps.origin.y, plan.states[i].yaw};
  }
  const Velocity& command() const noexcept override { return command_; }
  std::span<const maps::Pose> plan() const noexcept override { return plan_; }
  void reset(std::uint64_t seed) noexcept override { controller_.reset(seed); }

 private:
  Base base_;
  Controller<NavigationProblem<Base>> controller_;
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
