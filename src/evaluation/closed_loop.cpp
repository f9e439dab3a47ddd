#include "slalom/evaluation/closed_loop.hpp"

#include <stdexcept>

#include "evaluation/lap_state.hpp"

namespace slalom::evaluation {

ClosedLoop::ClosedLoop(std::shared_ptr<const LapRunner> runner, std::uint64_t seed)
    : runner_(std::move(runner)), seed_(seed), drive_(runner_->begin(seed)) {}
ClosedLoop::~ClosedLoop() = default;
ClosedLoop::ClosedLoop(ClosedLoop&&) noexcept = default;
ClosedLoop& ClosedLoop::operator=(ClosedLoop&&) noexcept = default;

void ClosedLoop::tick(const ControlStepCallback& on_step, double further_latency) {
  runner_->control(*drive_, on_step, further_latency);
  runner_->advance(*drive_, true);
}

void ClosedLoop::change_controller(std::shared_ptr<const LapRunner> runner) {
  if (runner->environment_ != runner_->environment_ || runner->control_period() != runner_->control_period())
    throw std::invalid_argument("loop: environment and control period cannot change on the way");
  auto planner = runner->make_planner();
  SequenceCostMeter meter(runner->environment_->path, runner->configuration_.vehicle);
  planner->reset(solver_seed(seed_, runner->method_));
  drive_->planner = std::move(planner);
  drive_->meter = std::move(meter);
  runner_ = std::move(runner);
}

int ClosedLoop::ticks() const noexcept {
  return drive_->result.steps;
}
sim::World& ClosedLoop::world() noexcept {
  return drive_->world;
}
const sim::World& ClosedLoop::world() const noexcept {
  return drive_->world;
}
int ClosedLoop::collisions() const noexcept {
  return runner_->environment_->protocol == Protocol::published ? drive_->log.published()
                                                                : drive_->log.collisions();
}

std::span<const Collision> ClosedLoop::first_collisions() const noexcept {
  return drive_->result.first_collisions;
}

}  // namespace slalom::evaluation
