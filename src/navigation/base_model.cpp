#include "navigation/base_model.hpp"

#include <optional>

#include "slalom/core/problem_evaluator.hpp"
#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/proposals.hpp"
#include "slalom/solvers/trajectories.hpp"

namespace slalom::navigation::detail {
namespace {

/// Evaluates batches of a navigation problem, whose cost may have a term of the user's. Batches are then
/// whole, so that a term in Python is called rarely, and by one thread.
template <class Base>
class NavigationEvaluator final : public BatchEvaluator {
 public:
  using Problem = NavigationProblem<Base>;
  using State = typename Problem::template State<double>;
  static constexpr int input_count = Base::inputs;

  explicit NavigationEvaluator(Problem problem) : evaluator_(std::move(problem)) {}

  Problem& problem() noexcept { return evaluator_.problem(); }
  const Problem& problem() const noexcept { return evaluator_.problem(); }
  void set_cost(StateCost cost) noexcept { cost_ = std::move(cost); }
  /// Sets the maps of the next rollouts.
  void set_maps(const NavigationMaps& maps) noexcept {
    problem().set_maps(maps);
    origin_ = maps.origin;
  }
  void set_state(const State& state) noexcept {
    start_ = state;
    evaluator_.set_state(state);
  }
  int inputs() const noexcept override { return input_count; }
  double time_step() const noexcept override { return evaluator_.time_step(); }
  bool whole_batches() const noexcept override { return static_cast<bool>(cost_); }
  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    evaluator_.evaluate(batch, first, count, costs, collided);
    if (!cost_) return;
    for (int done = 0; done < count; done += block)
      add_costs(batch, first + done, std::min(block, count - done), costs);
  }
  Cost<double> predict(const State& state, const Input<double, input_count>* u, int steps,
                       State* x) const noexcept {
    return slalom::predict(problem(), state, u, steps, x);
  }

  Trajectories roll_out(std::span<const float> sequences, int steps) const {
    return slalom::roll_out(evaluator_, start_, sequences, steps);
  }

 private:
  static constexpr int block = 1024;  ///< states in a call
  using Column = std::array<double, block>;

  void add_costs(const SequenceBatch& batch, int first, int count, float* costs) const noexcept {
    Column x, y, yaw, forward, left, turn, sums;
    std::array<Input<float, input_count>, block> before;
    const double step = time_step();
    x.fill(start_.x + origin_.x);
    y.fill(start_.y + origin_.y);
    yaw.fill(start_.yaw);
    sums.fill(0);
    for (auto& each : before)
      for (int i = 0; i < input_count; ++i) each[i] = static_cast<float>(start_.before[i]);
    const auto used = [&](Column& column) { return std::span(column).first(count); };
    for (int k = 0; k < batch.steps(); ++k) {
      for (int j = 0; j < count; ++j) {
        Input<float, input_count> u;
        for (int i = 0; i < input_count; ++i) u[i] = batch.at(k, i, first + j);
        before[j] = problem().driven(before[j], u);
        const VelocityOf<float> velocity = problem().velocity(before[j]);
        forward[j] = velocity.forward;
        left[j] = velocity.left;
        turn[j] = velocity.turn;
      }
      cost_({k, used(x), used(y), used(yaw), used(forward), used(left), used(turn)}, used(sums));
      for (int s = 0; s < count; ++s) {
        float sine, cosine;
        sin_cos(static_cast<float>(yaw[s]), sine, cosine);
        const double c = cosine, d = sine;
        x[s] += step * (c * forward[s] - d * left[s]);
        y[s] += step * (d * forward[s] + c * left[s]);
        yaw[s] += step * turn[s];
      }
    }
    for (int j = 0; j < count; ++j) costs[first + j] += static_cast<float>(step * sums[j]);
  }

  ProblemEvaluator<Problem> evaluator_;
  StateCost cost_;
  State start_{};
  maps::Point origin_;
};

/// The options for steps of this duration (s). Noise is smooth over a plan: in a longer one it turns farther.
SolverOptions fitted(SolverOptions options, double step) {
  // The plans for which variances are meant, s.
  const double usual = svg_mppi_options(BaseOptions{}).horizon * NavigatorOptions{}.time_step;
  const double share = std::min(usual / (*options.find<int>("horizon") * step), 1.0);
  visit_options(options, [&](auto& option, const Declaration& about) {
    if constexpr (std::is_same_v<decltype(option), PerInput&>) {
      if (std::string_view(about.unit) != "input^2") return;
      std::vector<double> values = option.values();
      for (double& value : values) value *= share;
      option = std::move(values);
    }
  });
  return options;
}

template <class Base>
class BaseModelOf final : public BaseModel {
 public:
  BaseModelOf(const NavigatorOptions& options, const Footprint& footprint, double resolution,
              const SolverOptions& solver)
      : controller_(NavigationEvaluator<Base>(NavigationProblem<Base>(options.base, options.costs, footprint,
                                                                      resolution, options.time_step)),
                    fitted(solver, options.time_step)),
        deadline_(options.deadline),
        plan_(controller_.solver().horizon() + 1) {
    if (!controller_.solver().takes_proposals()) return;
    // Braking, reversing, and turns either way; of a car, also straight on, or it would start with a turn.
    const BaseOptions& base = options.base;
    const double way = steers<Base> ? base.max_forward : 0;
    proposals_.emplace(controller_, steers<Base> ? 7 : 6);
    const auto add = [&](double forward, double turn) {
      const auto input = Base::input({forward, 0, turn});
      proposals_->add({&input, 1});
    };
    for (const double forward : {way, -base.max_reverse})
      for (const double turn : {base.max_turn, -base.max_turn, 0.0}) add(forward, turn);
    if (steers<Base>) add(0, 0);
  }
  std::unique_ptr<BaseModel> clone() const override { return std::make_unique<BaseModelOf>(*this); }

  void solve(const NavigationMaps& maps, const maps::Pose& pose, const Velocity& velocity,
             double elapsed) noexcept override {
    controller_.evaluator().set_maps(maps);
    origin_ = maps.origin;
    SolveRequest request{.elapsed = elapsed};
    if (deadline_ > 0) request.deadline = deadline_;
    if (proposals_) request.proposals = *proposals_;
    const auto plan = controller_.solve(
        {pose.x - maps.origin.x, pose.y - maps.origin.y, pose.yaw, maps.progress, 0, Base::input(velocity)},
        request);
    command_ = controller_.problem().velocity(plan.states[1].before);
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
      const Velocity velocity = controller_.problem().velocity(x.before);
      states.insert(states.end(), {x.x + origin_.x, x.y + origin_.y, x.yaw, velocity.forward, velocity.left,
                                   velocity.turn});
    }
    all.states = std::move(states);
    return all;
  }
  void reset(std::uint64_t seed) noexcept override { controller_.reset(seed); }
  void set_cost(StateCost cost) noexcept override { controller_.evaluator().set_cost(std::move(cost)); }

 private:
  using State = typename NavigationEvaluator<Base>::State;

  Controller<NavigationEvaluator<Base>> controller_;
  std::optional<Proposals<NavigationEvaluator<Base>>> proposals_;  ///< plans that every solve weighs
  maps::Point origin_;  ///< m, map frame, where the states of the last plan begin
  double deadline_;     ///< s; 0: none
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
