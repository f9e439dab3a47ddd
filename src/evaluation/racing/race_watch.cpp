#include "evaluation/racing/race_watch.hpp"

namespace slalom::evaluation {
namespace {

constexpr double lead = 1;  // m, from which a car has overtaken another

}  // namespace

RaceWatch::RaceWatch(const sim::World& world, double line) : judge_(world) {
  const double length = world.track().lap_path()->length();
  for (std::size_t car = 0; car < world.cars(); ++car)
    behind_.push_back(std::remainder(line - world.laps(car)->arc(), length));
  for (std::size_t first = 0; first < world.cars(); ++first)
    for (std::size_t second = first + 1; second < world.cars(); ++second)
      pairs_.push_back({.first = first, .second = second, .first_leads = behind_[first] <= behind_[second]});
}

void RaceWatch::update(const sim::World& world) {
  judge_.update(world);
  for (Pair& pair : pairs_) {
    const auto [first, second] = std::pair(pair.first, pair.second);
    if (!world.on_track(first) || !world.on_track(second)) continue;
    const auto colliding = world.observe(first).colliding;
    if (std::find(colliding.begin(), colliding.end(), static_cast<int>(second)) != colliding.end())
      collide(world, pair);
    const double ahead = distance(world, first) - distance(world, second);
    if ((pair.first_leads ? -ahead : ahead) < lead) continue;
    const auto winner = static_cast<int>(pair.first_leads ? second : first),
               loser = static_cast<int>(pair.first_leads ? first : second);
    overtakes_.push_back({.time = world.time(), .car = winner, .overtaken = loser});
    pair.first_leads = !pair.first_leads;
  }
}

void RaceWatch::collide(const sim::World& world, Pair& pair) {
  const bool goes_on = world.time() - pair.collided < contact_pause;
  pair.collided = world.time();
  if (goes_on) return;
  const auto first = static_cast<int>(pair.first), second = static_cast<int>(pair.second);
  contacts_.push_back({.time = world.time(),
                       .cars = {first, second},
                       .at_fault = judge_.at_fault(pair.first, pair.second) ? first : second,
                       .pose = world.observe(pair.first).pose});
}

double RaceWatch::last_collision(std::size_t car) const noexcept {
  double last = -1e9;
  for (const Pair& pair : pairs_)
    if (pair.first == car || pair.second == car) last = std::max(last, pair.collided);
  return last;
}

}  // namespace slalom::evaluation
