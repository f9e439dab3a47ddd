#include "vehicle/planner/sequence_choice.hpp"

#include <algorithm>
#include <cmath>

#include "slalom/core/math.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "vehicle/planner/car_scale.hpp"

namespace slalom::vehicle::detail {

namespace {

/// Deceleration while braking in curves, and acceleration, as shares of the largest deceleration.
constexpr double braking_share = 0.8, accelerating_share = 0.4;

/// The body without margin, or smaller by `less` (m), for look-ups in the map of these traits.
BodyOptions bare(const VehicleTraits& traits, double less) {
  BodyOptions body = traits.body;
  body.model = traits.obstacles.map == ObstacleMap::clearance ? BodyModel::discs : BodyModel::box;
  body.margin = std::min(body.margin, -less);
  body.soft_margin = 0;
  return body;
}

/// Whether one sequence is better than another: it alone is without a collision, else its cost is lower.
bool cheaper(const PredictedCost& one, const PredictedCost& other) {
  if (one.collided != other.collided) return other.collided;
  return one.state + one.collision < other.state + other.collision;
}

/// The index of the cheapest sample without collision, -1 if there is none.
int cheapest_sample(const SolveResult& result) {
  int cheapest = -1;
  for (int k = 0; result.samples && k < result.samples->samples(); ++k) {
    if (result.collided[k] || !std::isfinite(result.costs[k])) continue;
    if (cheapest < 0 || result.costs[k] < result.costs[cheapest]) cheapest = k;
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
      states_(static_cast<std::size_t>(horizon) + 1),
      candidate_states_(states_.size()),
      path_(states_.size()),
      margin_is_cost_(traits.tyres.seeks_lap_time && traits.body.margin > 0 &&
                      traits.obstacles.map == ObstacleMap::clearance),
      body_(bare(traits, margin_is_cost_ ? SensorErrors::reading : 0)) {}

void SequenceChoice::sees(const VehicleMaps& maps) noexcept {
  body_.set_map(maps.obstacles, maps.robot);
  others_ = maps.others;
  sees_ = true;
}

PredictedCost SequenceChoice::predict(const VehicleModel& model, std::span<const float> inputs,
                                      std::span<PredictedState> states) const noexcept {
  PredictedCost cost = model.predict(inputs, states);
  cost.collided = collides(cost, states.first(inputs.size() / inputs_ + 1));
  return cost;
}

/// Whether these states collide, or the body does between them. The cost is that of the model.
bool SequenceChoice::collides(const PredictedCost& cost,
                              std::span<const PredictedState> states) const noexcept {
  if (!sees_ || (cost.collided && !margin_is_cost_)) return cost.collided;
  return body_collides(states) || (cost.collided && others_collide(states));
}

/// Whether the body collides after the first free state (see VehicleModel::predict) or between two states, or
/// goes deeper into what it touches before: it would come out on the other side of a wall.
bool SequenceChoice::body_collides(std::span<const PredictedState> states) const noexcept {
  const auto touches = [&](std::size_t k, std::size_t next) {
    return body_.collides_before(states[k].pose, states[next].pose);
  };
  const double least_room = std::min(body_.room(states[0].pose), 0.0) - SensorErrors::body;
  std::size_t k = 0;
  for (; k < states.size() && touches(k, k); ++k)
    if (body_.room(states[k].pose) < least_room) return true;
  for (; k + 1 < states.size(); ++k)
    if (touches(k, k + 1)) return true;
  return k == states.size() || touches(k, k);
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

void SequenceChoice::begin(const VehicleModel& model, const SolveResult& result) noexcept {
  model_ = &model;
  result_ = &result;
  best_ = {result.inputs, predict(model, result.inputs, states_)};
}

bool SequenceChoice::consider(std::span<const float> inputs) noexcept {
  if (inputs.size() != candidate_.size()) return false;
  const PredictedCost predicted = model_->predict(inputs, candidate_states_);
  PredictedCost cost = predicted;
  cost.collided = predicted.collided && !margin_is_cost_;
  if (!cheaper(cost, best_.cost)) return false;  // nor would it be in a collision
  cost.collided = collides(predicted, candidate_states_);
  if (!cheaper(cost, best_.cost)) return false;
  best_ = {inputs, cost};
  states_.swap(candidate_states_);
  return true;
}

void SequenceChoice::consider_last(double elapsed) noexcept {
  if (!has_previous_) return;
  const std::size_t last = previous_.size() - inputs_;
  const double moved = elapsed / traits_.time_step, whole = std::floor(moved);
  const auto share = static_cast<float>(moved - whole);
  const std::size_t shift = saturate_cast<std::size_t>(std::min(whole, static_cast<double>(last))) * inputs_;
  for (std::size_t row = 0; row < previous_.size(); ++row) {
    const std::size_t before = std::min(row + shift, last + row % inputs_),
                      after = std::min(before + inputs_, last + row % inputs_);
    kept_[row] = previous_[before] + share * (previous_[after] - previous_[before]);
  }
  consider(kept_);
}

void SequenceChoice::consider_slower() noexcept {
  std::copy(states_.begin(), states_.end(), path_.begin());
  // Each is at most twice as long as the one before, so that one of them brakes at most twice as long as it
  // must. In 16 steps of 0.05 s the usable grip takes 6.7 m/s off the speed of the car.
  for (const int steps : {0, 3, 6, 10, 16}) {
    follow_slower(steps);
    if (consider(candidate_)) candidate_.swap(slower_);
  }
}

void SequenceChoice::consider_samples() noexcept {
  for_each_known({}, [&](std::span<const float> inputs) { consider(inputs); });
  const int sample = cheapest_sample(*result_);
  if (sample < 0) return;
  for (std::size_t row = 0; row < candidate_.size(); ++row)
    candidate_[row] =
        result_->samples->at(static_cast<int>(row / inputs_), static_cast<int>(row % inputs_), sample);
  consider(candidate_);
}

void SequenceChoice::stop(bool reversing) noexcept {
  const std::span<const PredictedState> start(states_.data(), 1);
  const bool begins_free = margin_is_cost_ && !body_collides(start) && !others_collide(start);
  if (begins_free && !reversing) return least_harm();
  brake(reversing ? max_deceleration_ : -max_deceleration_);
}

/// Calls `use` with `last`, the nominal sequence and each guide, as far as they exist. `last` is the sequence
/// sent last, as it was or moved to the present; empty, it is left out.
template <class Use>
void SequenceChoice::for_each_known(std::span<const float> last, Use&& use) const {
  const std::size_t size = candidate_.size();
  if (has_previous_ && !last.empty()) use(last);
  if (result_->nominal.size() == size) use(result_->nominal);
  for (int g = 0; g < result_->guides.sequences; ++g)
    use(result_->guides.values.subspan(static_cast<std::size_t>(g) * size, size));
}

/// Sets `candidate_` to inputs that brake for `braking_steps` steps and then accelerate. At each place the
/// wheels have the same angle as in `path_`.
void SequenceChoice::follow_slower(int braking_steps) noexcept {
  const double dt = traits_.time_step, change = traits_.max_deceleration;
  const std::size_t steps = path_.size() - 1;
  std::size_t at = 0;                                       // the state of `path_` that was passed last
  double speed = std::max(path_[0].speed, 0.0), ahead = 0;  // m/s, m beyond that state
  const auto way = [&] { return std::abs(path_[at].speed) * dt; };  // m to the next state
  for (std::size_t k = 0; k < steps; ++k) {
    const bool brakes = static_cast<int>(k) < braking_steps;
    const double before = speed, fastest = std::max(path_[at].speed, before);
    speed = brakes ? std::max(before - braking_share * change * dt, 0.0)
                   : std::min(before + accelerating_share * change * dt, fastest);
    ahead += 0.5 * (before + speed) * dt;
    for (; at + 1 < steps && way() > 0 && ahead >= way(); ++at) ahead -= way();
    const double slowness = speed / traits_.tyres.half_steer_speed;
    candidate_[k * inputs_] = static_cast<float>(path_[at + 1].steer * (1 + slowness * slowness));
    candidate_[k * inputs_ + 1] = brakes ? -max_deceleration_ : max_deceleration_;
  }
}

/// Sets `candidate_` to this steering, with the same acceleration (m/s^2) in all steps.
void SequenceChoice::set_acceleration(std::span<const float> steering, float acceleration) noexcept {
  for (std::size_t row = 0; row < candidate_.size(); ++row)
    candidate_[row] = row % inputs_ == 0 ? steering[row] : acceleration;
}

/// Takes the cheapest full stop with the steering of one of the known sequences.
void SequenceChoice::brake(float acceleration) noexcept {
  bool first = true;
  const auto consider_stop = [&](std::span<const float> steering) {
    set_acceleration(steering, acceleration);
    const PredictedCost cost = predict(*model_, candidate_, candidate_states_), &best = best_.cost;
    const bool better = best.collided != cost.collided ? best.collided : cost.collision < best.collision;
    if (!first && !better) return;
    first = false;
    candidate_.swap(braking_);
    best_ = {braking_, cost};
    states_.swap(candidate_states_);
  };
  consider_stop(best_.inputs);
  for_each_known(previous_, consider_stop);
}

/// Returns the harm of a sequence: the squared speed (m^2/s^2) of its first collision, times the share of the
/// sequence that follows, since a collision far ahead can still be avoided. Returns 0 without a collision.
double SequenceChoice::harm(std::span<const float> inputs) noexcept {
  const std::size_t steps = inputs.size() / inputs_;
  const auto collides = [&](std::size_t end) {
    return predict(*model_, inputs.first(end * inputs_), candidate_states_).collided;
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

/// Takes the least harmful of sequences that all collide: the best so far, the sequence sent last (`kept_`),
/// the nominal sequence or a guide, each with its own acceleration and with full braking; or full braking
/// with straight wheels, which leaves all the grip for braking.
void SequenceChoice::least_harm() noexcept {
  std::vector<float>& chosen = braking_;
  std::copy(best_.inputs.begin(), best_.inputs.end(), chosen.begin());
  double least = harm(chosen);
  const auto take_candidate_below = [&](double limit) {
    const double found = harm(candidate_);
    if (found >= limit) return false;
    least = found;
    candidate_.swap(chosen);
    return true;
  };

  // Each sequence with its own acceleration.
  for_each_known(kept_, [&](std::span<const float> inputs) {
    std::copy(inputs.begin(), inputs.end(), candidate_.begin());
    take_candidate_below(least);
  });

  // Each steering with full braking, which takes grip from turning: the first must do clearly less harm.
  double share = 0.8;
  const auto try_braking = [&](std::span<const float> steering) {
    set_acceleration(steering, -max_deceleration_);
    if (take_candidate_below(share * least)) share = 1;
  };
  std::vector<float>& steering = slower_;
  std::copy(chosen.begin(), chosen.end(), steering.begin());
  try_braking(steering);
  for_each_known(kept_, try_braking);
  std::fill(steering.begin(), steering.end(), 0.0f);
  try_braking(steering);

  best_ = {chosen, predict(*model_, chosen, states_)};
}

}  // namespace slalom::vehicle::detail
