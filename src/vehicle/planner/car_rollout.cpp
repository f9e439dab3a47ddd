#include "vehicle/planner/car_rollout.hpp"

#include "slalom/core/problem_evaluator.hpp"

namespace slalom::vehicle::detail {

namespace {

template <bool separate_local, int input_count = 1>
class Rollout final : public CarRollout {
  using Problem = PathTracking<separate_local, input_count>;
  using State = typename Problem::template State<double>;

 public:
  explicit Rollout(const PathTrackingOptions& options) : evaluator_(Problem(options)) {}

  void set_maps(const GridView<4>& reference, const GridView<1>& obstacles,
                const maps::Pose& robot) noexcept override {
    evaluator_.problem().set_maps(reference, obstacles, robot.x, robot.y, robot.yaw);
    robot_ = robot;
  }

  void set_start(const CarStart& start, double target_speed) noexcept override {
    start_ = {};
    start_.x = start.pose.x;
    start_.y = start.pose.y;
    start_.yaw = start.pose.yaw;
    start_.speed = start.speed;
    start_.steer = start.steer;
    if constexpr (separate_local) {
      const maps::Point local = maps::inverse_transform(robot_, {start.pose.x, start.pose.y});
      start_.local_x = local.x;
      start_.local_y = local.y;
      start_.local_yaw = start.pose.yaw - robot_.yaw;
    }
    evaluator_.problem().set_target_speed(target_speed);
    evaluator_.set_state(start_);
  }

  const BatchEvaluator& evaluator() const noexcept override { return evaluator_; }
  int inputs() const noexcept override { return input_count; }

  bool start_collides() const noexcept override {
    const Problem& problem = evaluator_.problem();
    return problem.stage_cost(start_, problem.look_up(start_), Input<double, input_count>{}).collided;
  }

  PredictedCost predict(std::span<const float> inputs,
                        std::span<PredictedState> states) const noexcept override {
    const Problem& problem = evaluator_.problem();
    const PathTrackingOptions& options = problem.options();
    PredictedCost total;
    State s = start_;
    bool was_free = false;
    const std::size_t steps = inputs.size() / input_count;
    for (std::size_t k = 0; k <= steps; ++k) {
      states[k] = predicted(s);
      const auto seen = problem.look_up(s);
      const bool last = k == steps;
      Input<double, input_count> u{};
      for (std::size_t i = 0; !last && i < input_count; ++i)
        u.value[i] = static_cast<double>(inputs[k * input_count + i]);
      const Cost<double> cost = last ? problem.terminal_cost(s, seen) : problem.stage_cost(s, seen, u);
      const double collision =
          problem.collision_cost(seen, last ? options.outside_terminal_cost : options.outside_cost);
      total.state += cost.value - collision;
      total.distance +=
          (last ? options.terminal_distance_weight : options.distance_weight) * square(seen.distance);
      total.collision += collision;
      total.collided |= cost.collided && was_free;
      was_free |= !cost.collided;
      if (!last) s = problem.step(s, seen, u, static_cast<int>(k));
    }
    total.collided |= !was_free;
    return total;
  }

 private:
  PredictedState predicted(const State& s) const noexcept {
    PredictedState p{{s.x, s.y, s.yaw}, s.speed, s.steer, {}};
    if constexpr (separate_local) {
      p.local = {s.local_x, s.local_y, s.local_yaw};
    } else {
      const maps::Point local = maps::inverse_transform(robot_, {s.x, s.y});
      p.local = {local.x, local.y, s.yaw - robot_.yaw};
    }
    return p;
  }

  ProblemEvaluator<Problem> evaluator_;
  State start_{};
  maps::Pose robot_;
};

}  // namespace

std::unique_ptr<CarRollout> CarRollout::make(const PathTrackingOptions& options) {
  if (input_count(options) == 2) return std::make_unique<Rollout<false, 2>>(options);
  if (options.straight_local_rollout) return std::make_unique<Rollout<true>>(options);
  return std::make_unique<Rollout<false>>(options);
}

}  // namespace slalom::vehicle::detail
