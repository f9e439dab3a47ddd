#include "slalom/evaluation/closed_loop.hpp"

#include <stdexcept>

#include "evaluation/lap_in_progress.hpp"
#include "evaluation/lap_rules.hpp"

namespace slalom::evaluation {

ClosedLoop::ClosedLoop(std::shared_ptr<const LapRunner> runner, std::uint64_t seed)
    : runner_(std::move(runner)), seed_(seed), lap_(runner_->begin(seed)) {}
ClosedLoop::~ClosedLoop() = default;
ClosedLoop::ClosedLoop(ClosedLoop&&) noexcept = default;
ClosedLoop& ClosedLoop::operator=(ClosedLoop&&) noexcept = default;

void ClosedLoop::step(const ControlStepCallback& on_step, double extra_latency) {
  runner_->control(*lap_, on_step, extra_latency);
  runner_->advance(*lap_, true);
}

void ClosedLoop::change_controller(std::shared_ptr<const LapRunner> runner) {
  if (runner->environment_ != runner_->environment_)
    throw std::invalid_argument("runner: must have the same environment as the current runner");
  if (runner->control_period() != runner_->control_period())
    throw std::invalid_argument("runner: must have the same control period as the current runner");
  auto planner = runner->make_planner();
  SequenceCostMeter meter(runner->environment_->path, runner->configuration_.vehicle);
  planner->reset(solver_seed(seed_, runner->method_));
  lap_->driver->change(*runner, std::move(planner));
  lap_->meter = std::move(meter);
  runner_ = std::move(runner);
}

int ClosedLoop::steps() const noexcept {
  return lap_->result.steps;
}
sim::World& ClosedLoop::world() noexcept {
  return lap_->world;
}
const sim::World& ClosedLoop::world() const noexcept {
  return lap_->world;
}
int ClosedLoop::collisions() const noexcept {
  return rules_of(runner_->environment_->protocol).collisions(lap_->log);
}
std::span<const Collision> ClosedLoop::first_collisions() const noexcept {
  return lap_->result.first_collisions;
}

}  // namespace slalom::evaluation
