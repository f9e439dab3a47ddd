#include "vehicle/planner/sequence_choice.hpp"

#include <algorithm>
#include <cmath>

#include "slalom/core/math.hpp"

namespace slalom::vehicle::detail {

namespace {

/// Deceleration while braking in curves, and acceleration, as shares of the largest deceleration.
constexpr double braking_share = 0.8, accelerating_share = 0.4;

/// m, between a wall and the nearest of many noisy readings of it.
constexpr double reading_error = 0.02;

/// A body without margin.
BodyOptions bare(BodyOptions body) {
  body.margin = std::min(body.margin, -reading_error);
  body.soft_margin = 0;
  return body;
}

/// Whether one sequence is better than another: without a collision if the other has one, else at a lower
/// cost.
bool cheaper(const PredictedCost& one, const PredictedCost& other) {
  if (one.collided != other.collided) return other.collided;
  return one.state + one.collision < other.state + other.collision;
}

/// Calls `use` with each guide's sequence of `size` values.
template <class Use>
void for_each_guide(const SolveResult& result, std::size_t size, Use&& use) {
  for (int g = 0; g < result.guides.sequences; ++g)
    use(result.guides.values.subspan(static_cast<std::size_t>(g) * size, size));
}

/// The index of the cheapest sample without collision, -1 if there is none.
int cheapest_sample(const SolveResult& result) {
  int cheapest = -1;
  for (int k = 0; result.samples && k < result.samples->samples(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (result.collided[i] || !std::isfinite(result.costs[i])) continue;
    if (cheapest < 0 || result.costs[i] < result.costs[static_cast<std::size_t>(cheapest)]) cheapest = k;
  }
  return cheapest;
}

}  // namespace

SequenceChoice::SequenceChoice(int horizon, int inputs, const VehicleTraits& traits)
    : inputs_(static_cast<std::size_t>(inputs)),
      traits_(traits),
      max_deceleration_(static_cast<float>(traits.max_deceleration)),
      candidate_(static_cast<std::size_t>(horizon) * inputs_),
      braking_(candidate_.size()),
      previous_(candidate_.size()),
      kept_(candidate_.size()),
      slower_(candidate_.size()),
      candidate_states_(static_cast<std::size_t>(horizon) + 1),
      path_(candidate_states_.size()) {
  if (traits.seeks_lap_time && traits.body.margin > 0 && traits.obstacle_map == ObstacleMap::clearance)
    body_.emplace(bare(traits.body));
}

void SequenceChoice::sees(const GridView<1>& clearances, const maps::MovingObstaclesView& others) noexcept {
  if (body_) body_->set_map(clearances, {});
  others_ = others;
}

PredictedCost SequenceChoice::predict(const VehicleModel& model, std::span<const float> inputs,
                                      std::vector<PredictedState>& states) const noexcept {
  PredictedCost cost = model.predict(inputs, states);
  if (!body_ || !cost.collided) return cost;
  const std::span<const PredictedState> predicted{states.data(), inputs.size() / inputs_ + 1};
  cost.collided = body_collides(predicted) || others_collide(predicted);
  return cost;
}

/// Whether the body collides after the first free state, as VehicleModel::predict has it.
bool SequenceChoice::body_collides(std::span<const PredictedState> states) const noexcept {
  bool was_free = false;
  for (const PredictedState& s : states) {
    const double value = body_->in_robot_frame(s.local.x, s.local.y, s.local.yaw);
    const bool collides = value < 0 || value >= 100;
    if (collides && was_free) return true;
    was_free |= !collides;
  }
  return !was_free;
}

/// Whether the car collides with another one after the first state that is free of them.
bool SequenceChoice::others_collide(std::span<const PredictedState> states) const noexcept {
  if (others_.empty()) return false;
  bool was_free = false;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const maps::Pose& at = states[k].pose;
    const int step = std::min(static_cast<int>(k), others_.last_step());
    const bool collides = others_.cost(at.x, at.y, std::sin(at.yaw), std::cos(at.yaw), step).collided;
    if (collides && was_free) return true;
    was_free |= !collides;
  }
  return !was_free;
}

void SequenceChoice::sent(std::span<const float> inputs) noexcept {
  has_previous_ = inputs.size() == previous_.size();
  if (has_previous_) std::copy(inputs.begin(), inputs.end(), previous_.begin());
}

SequenceChoice::Choice SequenceChoice::cheapest(const VehicleModel& model, const SolveResult& result,
                                                const Choice& solution,
                                                std::vector<PredictedState>& states) noexcept {
  Choice best = solution;
  const auto consider = [&](std::span<const float> inputs) {
    if (inputs.size() != candidate_.size()) return;
    const PredictedCost cost = predict(model, inputs, candidate_states_);
    if (!cheaper(cost, best.cost)) return;
    best = {inputs, cost};
    states.swap(candidate_states_);
  };
  consider(result.nominal);
  for_each_guide(result, candidate_.size(), consider);
  if (const int sample = cheapest_sample(result); sample >= 0) {
    for (std::size_t row = 0; row < candidate_.size(); ++row)
      candidate_[row] =
          result.samples->at(static_cast<int>(row / inputs_), static_cast<int>(row % inputs_), sample);
    consider(candidate_);
  }
  return best;
}

SequenceChoice::Choice SequenceChoice::stop(const VehicleModel& model, const SolveResult& result,
                                            const Choice& solution, bool reversing,
                                            std::vector<PredictedState>& states) noexcept {
  const bool begins_free = body_ && !body_collides({states.data(), 1}) && !others_collide({states.data(), 1});
  if (begins_free && !reversing) return least_harm(model, result, solution, states);
  return brake(model, result, solution, reversing, states);
}

SequenceChoice::Choice SequenceChoice::kept(const VehicleModel& model, const Choice& solution, double elapsed,
                                            std::vector<PredictedState>& states) noexcept {
  if (!has_previous_) return solution;
  const std::size_t last = previous_.size() - inputs_;
  const double moved = elapsed / traits_.time_step, whole = std::floor(moved);
  const auto share = static_cast<float>(moved - whole);
  const std::size_t shift = static_cast<std::size_t>(whole) * inputs_;
  for (std::size_t row = 0; row < previous_.size(); ++row) {
    const std::size_t before = std::min(row + shift, last + row % inputs_),
                      after = std::min(before + inputs_, last + row % inputs_);
    kept_[row] = previous_[before] + share * (previous_[after] - previous_[before]);
  }
  return better(model, solution, kept_, states);
}

SequenceChoice::Choice SequenceChoice::better(const VehicleModel& model, const Choice& solution,
                                              std::span<const float> other,
                                              std::vector<PredictedState>& states) noexcept {
  if (other.size() != candidate_.size()) return solution;
  const PredictedCost cost = predict(model, other, candidate_states_);
  if (!cheaper(cost, solution.cost)) return solution;
  states.swap(candidate_states_);
  return {other, cost};
}

SequenceChoice::Choice SequenceChoice::slower(const VehicleModel& model, const Choice& solution,
                                              std::vector<PredictedState>& states) noexcept {
  Choice best = solution;
  std::copy(states.begin(), states.end(), path_.begin());
  for (const int steps : {0, 3, 6, 10, 16}) {
    follow_slower(steps);
    const PredictedCost cost = predict(model, candidate_, candidate_states_);
    if (!cheaper(cost, best.cost)) continue;
    candidate_.swap(slower_);
    best = {slower_, cost};
    states.swap(candidate_states_);
  }
  return best;
}

/// Sets `candidate_` to inputs that brake for `braking_steps` steps and then accelerate. At each place the
/// wheels have the same angle as in `path_`.
void SequenceChoice::follow_slower(int braking_steps) noexcept {
  const double dt = traits_.time_step;
  const std::size_t steps = path_.size() - 1;
  double speed = std::max(path_[0].speed, 0.0), ahead = 0;  // m/s, m beyond the state `at`
  std::size_t at = 0;
  for (std::size_t k = 0; k < steps; ++k) {
    const bool brakes = static_cast<int>(k) < braking_steps;
    const double before = speed;
    speed =
        std::max(speed + (brakes ? -braking_share : accelerating_share) * traits_.max_deceleration * dt, 0.0);
    speed = brakes ? speed : std::min(speed, std::max(path_[at].speed, before));
    ahead += 0.5 * (before + speed) * dt;
    for (double way = std::abs(path_[at].speed) * dt; at + 1 < steps && ahead >= way && way > 0;) {
      ahead -= way;
      way = std::abs(path_[++at].speed) * dt;
    }
    const double slowness = speed / traits_.half_steer_speed;
    candidate_[k * inputs_] = static_cast<float>(path_[at + 1].steer * (1 + slowness * slowness));
    candidate_[k * inputs_ + 1] = brakes ? -max_deceleration_ : max_deceleration_;
  }
}

/// Returns the cheapest full stop with the steering of one of the known sequences.
SequenceChoice::Choice SequenceChoice::brake(const VehicleModel& model, const SolveResult& result,
                                             const Choice& solution, bool reversing,
                                             std::vector<PredictedState>& states) noexcept {
  Choice best = solution;
  bool first = true;
  const auto consider = [&](std::span<const float> steering) {
    if (steering.size() != candidate_.size()) return;
    const float braking = reversing ? max_deceleration_ : -max_deceleration_;
    for (std::size_t row = 0; row < candidate_.size(); ++row)
      candidate_[row] = row % inputs_ == 0 ? steering[row] : braking;
    const PredictedCost cost = predict(model, candidate_, candidate_states_);
    const bool better =
        best.cost.collided != cost.collided ? best.cost.collided : cost.collision < best.cost.collision;
    if (!first && !better) return;
    first = false;
    candidate_.swap(braking_);
    best = {braking_, cost};
    states.swap(candidate_states_);
  };
  consider(best.inputs);
  if (has_previous_) consider(previous_);
  consider(result.nominal);
  for_each_guide(result, candidate_.size(), consider);
  return best;
}

/// Returns the harm of a sequence: the squared speed (m^2/s^2) of its first collision, times the share of its
/// steps after it, since a collision far ahead can still be avoided. Returns 0 without a collision.
double SequenceChoice::harm(const VehicleModel& model, std::span<const float> inputs) noexcept {
  const std::size_t steps = inputs.size() / inputs_;
  const auto collides = [&](std::size_t end) {
    return predict(model, inputs.first(end * inputs_), candidate_states_).collided;
  };
  if (!collides(steps)) return 0;
  std::size_t free = 0, collided = steps;  // states; the start does not collide
  while (collided - free > 1) {
    const std::size_t middle = free + (collided - free) / 2;
    (collides(middle) ? collided : free) = middle;
  }
  const double left = static_cast<double>(steps + 1 - collided) / static_cast<double>(steps);
  collides(collided);
  return left * square(candidate_states_[collided].speed);
}

/// Returns the least harmful of sequences that all collide: the solution, the sequence sent last (`kept_`),
/// the nominal sequence or a guide, each with its own acceleration and with full braking; or full braking
/// with straight wheels, which leaves all the grip for braking. A braking sequence must do clearly less harm,
/// since braking takes grip from the turn that the car is in.
SequenceChoice::Choice SequenceChoice::least_harm(const VehicleModel& model, const SolveResult& result,
                                                  const Choice& solution,
                                                  std::vector<PredictedState>& states) noexcept {
  std::copy(solution.inputs.begin(), solution.inputs.end(), braking_.begin());
  double least = harm(model, braking_);
  const auto consider = [&](double share) {
    const double found = harm(model, candidate_);
    if (found >= share * least) return false;
    least = found;
    candidate_.swap(braking_);
    return true;
  };
  const auto for_each = [&](auto&& use) {
    if (has_previous_) use(std::span<const float>(kept_));
    use(result.nominal);
    for_each_guide(result, candidate_.size(), use);
  };
  for_each([&](std::span<const float> inputs) {
    if (inputs.size() != candidate_.size()) return;
    std::copy(inputs.begin(), inputs.end(), candidate_.begin());
    consider(1);
  });
  constexpr double clearly = 0.8;
  double share = clearly;
  const auto braked = [&](std::span<const float> steering) {
    if (!steering.empty() && steering.size() != candidate_.size()) return;
    for (std::size_t row = 0; row < candidate_.size(); ++row)
      candidate_[row] = row % inputs_ != 0 ? -max_deceleration_ : steering.empty() ? 0 : steering[row];
    if (consider(share)) share = 1;
  };
  std::copy(braking_.begin(), braking_.end(), slower_.begin());
  braked(slower_);
  for_each(braked);
  braked({});
  return {braking_, predict(model, braking_, states)};
}

}  // namespace slalom::vehicle::detail
