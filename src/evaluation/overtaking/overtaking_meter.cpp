#include "evaluation/overtaking/overtaking_meter.hpp"

namespace slalom::evaluation {
namespace {

constexpr double snapshot_interval = 0.05;  // s

constexpr double meeting_gap = 4, ahead_gap = 1;  // m
constexpr double rounds_to_overtake = 2;          // times around the course

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

OvertakingMeter::OvertakingMeter(const sim::World& world)
    : judge_(world), opponents_(world.cars() - 1), width_(world.options().car.width) {
  const double length = world.track().lap_path()->length();
  for (std::size_t i = 0; i < opponents_.size(); ++i) {
    const double ahead = world.laps(i + 1)->arc() - world.laps(0)->arc();
    opponents_[i].start_gap = ahead < 0 ? ahead + length : ahead;
  }
}

/// m along the course from the first car to another. It counts whole turns: a car that is lapped is a course
/// length behind.
double OvertakingMeter::gap(const sim::World& world, std::size_t car) const {
  return opponents_[car - 1].start_gap + world.laps(car)->progress() - world.laps(0)->progress();
}

void OvertakingMeter::update(const sim::World& world) {
  judge_.update(world);
  for (std::size_t car = 1; car <= opponents_.size(); ++car) meet(world, car);
  for (const int body : world.observe(0).colliding)
    if (body > 0 && static_cast<std::size_t>(body) < world.cars())
      collide(world, static_cast<std::size_t>(body));
}

/// Begins and ends encounters.
void OvertakingMeter::meet(const sim::World& world, std::size_t car) {
  Opponent& opponent = opponents_[car - 1];
  const double length = world.track().lap_path()->length(), progress = world.laps(0)->progress();
  const double apart = gap(world, car);
  if (opponent.encounter < 0) {
    const double turns = std::round(apart / length) * length;
    if (apart - turns < ahead_gap || apart - turns > meeting_gap) return;
    opponent.encounter = static_cast<int>(record_.encounters.size());
    opponent.met_gap = turns;
    opponent.met_progress = progress;
    opponent.side = 0;
    record_.encounters.push_back({.opponent = static_cast<int>(car) - 1, .time = world.time()});
  }
  Encounter& encounter = record_.encounters[static_cast<std::size_t>(opponent.encounter)];
  encounter.duration = world.time() - encounter.time;
  if (apart - opponent.met_gap <= meeting_gap) note_side(world, car, encounter);
  const bool ahead = apart - opponent.met_gap <= -ahead_gap;
  if (!ahead && progress - opponent.met_progress < rounds_to_overtake * length) return;
  encounter.end = ahead ? EncounterEnd::overtaken : EncounterEnd::not_overtaken;
  opponent.encounter = -1;
}

/// Counts a change of the side on which the first car is near an opponent.
void OvertakingMeter::note_side(const sim::World& world, std::size_t car, Encounter& encounter) {
  const double left = world.laps(0)->offset() - world.laps(car)->offset();
  if (std::abs(left) < width_) return;
  int& side = opponents_[car - 1].side;
  const int now = left > 0 ? 1 : -1;
  encounter.side_changes += side == -now;
  side = now;
}

void OvertakingMeter::collide(const sim::World& world, std::size_t car) {
  Opponent& opponent = opponents_[car - 1];
  const bool goes_on = world.time() - opponent.collided < contact_pause;
  opponent.collided = world.time();
  if (goes_on) return;
  const bool caused = judge_.at_fault(0, car);
  ++record_.contacts;
  record_.caused += caused;
  if (opponent.encounter < 0) return;
  Encounter& encounter = record_.encounters[static_cast<std::size_t>(opponent.encounter)];
  ++encounter.contacts;
  encounter.caused += caused;
}

OvertakingRecord OvertakingMeter::record(bool timed_out) const {
  OvertakingRecord record = record_;
  for (Encounter& each : record.encounters)
    if (timed_out && each.end == EncounterEnd::open) each.end = EncounterEnd::not_overtaken;
  return record;
}

}  // namespace slalom::evaluation
