#include "slalom/evaluation/ride.hpp"

#include <stdexcept>

#include "evaluation/lap_drive.hpp"

namespace slalom::evaluation {

Ride::Ride(std::shared_ptr<const LapRunner> runner, std::uint64_t seed)
    : runner_(std::move(runner)), seed_(seed), drive_(runner_->begin(seed)) {}
Ride::~Ride() = default;
Ride::Ride(Ride&&) noexcept = default;
Ride& Ride::operator=(Ride&&) noexcept = default;

void Ride::tick(const TickCallback& on_tick, double further_latency) {
  runner_->control(*drive_, on_tick, further_latency);
  runner_->advance(*drive_, true);
}

void Ride::change_driver(std::shared_ptr<const LapRunner> runner) {
  if (runner->arena_ != runner_->arena_ || runner->control_period() != runner_->control_period())
    throw std::invalid_argument("ride: arena and control period cannot change on the way");
  auto planner = runner->make_planner();
  SequenceCostMeter meter(runner->arena_->path, runner->configuration_.vehicle);
  planner->reset(solver_seed(seed_, runner->method_));
  drive_->planner = std::move(planner);
  drive_->meter = std::move(meter);
  runner_ = std::move(runner);
}

int Ride::ticks() const noexcept {
  return drive_->result.steps;
}
sim::World& Ride::world() noexcept {
  return drive_->world;
}
const sim::World& Ride::world() const noexcept {
  return drive_->world;
}
int Ride::contacts() const noexcept {
  return runner_->arena_->evaluation == Evaluation::published ? drive_->log.published()
                                                              : drive_->log.bodies_touched();
}

std::span<const Contact> Ride::touches() const noexcept {
  return drive_->result.touches;
}

}  // namespace slalom::evaluation
