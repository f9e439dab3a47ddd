#pragma once

#include "evaluation/overtaking/overtaking_meter.hpp"
#include "slalom/evaluation/grid_race.hpp"

namespace slalom::evaluation {

/// Watches the cars of a race: how far they are, who collides with whom and who overtakes whom. Cars have
/// their numbers in the world here.
class RaceWatch {
 public:
  /// Begins with the cars on the grid. `line` is the arc length (m) of the finish line.
  RaceWatch(const sim::World& world, double line);

  /// To be called after each step of the world.
  void update(const sim::World& world);

  /// m along the course beyond the finish line as it was at the start.
  double distance(const sim::World& world, std::size_t car) const noexcept {
    return world.laps(car)->progress() - behind_[car];
  }
  /// s, when a car last collided with another.
  double last_collision(std::size_t car) const noexcept;
  const std::vector<CarContact>& contacts() const noexcept {
    return contacts_;
  }  ///< contacts in order of time
  const std::vector<Overtake>& overtakes() const noexcept {
    return overtakes_;
  }  ///< overtakes in order of time

 private:
  /// The state of two cars.
  struct Pair {
    std::size_t first = 0, second = 0;
    bool first_leads = true;  ///< was the last to be 1 m ahead
    double collided = -1e9;   ///< s, when they last collided
  };
  void collide(const sim::World& world, Pair& pair);

  FaultJudge judge_;
  std::vector<double> behind_;  ///< m, per car: from its place on the grid to the line
  std::vector<Pair> pairs_;
  std::vector<CarContact> contacts_;
  std::vector<Overtake> overtakes_;
};

}  // namespace slalom::evaluation
