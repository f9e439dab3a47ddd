#include "evaluation/overtaking/fault_judge.hpp"

namespace slalom::evaluation {
namespace {

constexpr double snapshot_interval = 0.05;  // s

}  // namespace

FaultJudge::FaultJudge(const sim::World& world)
    : length_(world.track().lap_path()->length()), wheelbase_(world.options().car.wheelbase()) {
  for (std::size_t car = 0; car < world.cars(); ++car) before_.push_back(course_state(world, car));
  long_before_ = before_;
}

FaultJudge::CourseState FaultJudge::course_state(const sim::World& world, std::size_t car) {
  const sim::CarState& state = world.state(car);
  const double arc = world.laps(car)->arc();
  const double turned = state.yaw + state.slip - world.track().lap_path()->at(arc).yaw;
  return {arc, world.laps(car)->offset(), state.speed * std::sin(turned)};
}

void FaultJudge::update(const sim::World& world) {
  if (world.time() - snapshot_ < snapshot_interval) return;
  snapshot_ = world.time();
  long_before_.swap(before_);
  for (std::size_t car = 0; car < before_.size(); ++car) before_[car] = course_state(world, car);
}

bool FaultJudge::at_fault(std::size_t car, std::size_t other) const noexcept {
  const CourseState &own = long_before_[car], &theirs = long_before_[other];
  const double gap = std::remainder(theirs.arc - own.arc, length_);
  if (std::abs(gap) > wheelbase_) return gap > 0;
  const double side = theirs.offset > own.offset ? 1 : -1;
  return side * own.sideways >= -side * theirs.sideways;
}

}  // namespace slalom::evaluation
