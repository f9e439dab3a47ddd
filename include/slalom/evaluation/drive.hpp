#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

namespace slalom::evaluation {

/// The loop that drives a world: in each step all drivers decide, then the world moves for one control
/// period. Laps, races, rooms and the racing benchmark use it. If world and drivers can be copied, so can the
/// drive; a copy continues bit for bit like the original.
///
/// A world has `step(commands)`, with one command per driver. A driver has
///
///     Update decide(const World&)       // once per control period: sense and plan
///     Command command(const World&)     // before each step of the world
///     void moved(const World&)          // after each step of the world
///
/// An observer, such as a meter, judge or recorder, has
///
///     void decided(std::size_t driver, const Update&)   // after each decision
///     bool moved(World&)                                // after each step; false ends the period early
template <class World, class Driver>
struct Drive {
  /// A command of a driver.
  using Command =
      std::remove_cvref_t<decltype(std::declval<Driver&>().command(std::declval<const World&>()))>;

  World world;                      ///< world that moves
  std::vector<Driver> drivers;      ///< one for each car or robot of the world
  long long steps_per_command = 1;  ///< steps of the world in a control period
  std::vector<Command> commands{};  ///< commands of the last step of the world, one per driver

  /// Drives one control period: all drivers decide, then the world moves.
  template <class Observer>
  void step(Observer& observer) {
    for (std::size_t i = 0; i < drivers.size(); ++i)
      observer.decided(i, drivers[i].decide(std::as_const(world)));
    for (long long k = 0; k < steps_per_command; ++k) {
      commands.clear();
      for (Driver& driver : drivers) commands.push_back(driver.command(std::as_const(world)));
      world.step(commands);
      for (Driver& driver : drivers) driver.moved(std::as_const(world));
      if (!observer.moved(world)) return;
    }
  }
};

/// An observer made of two functions.
template <class Decided, class Moved>
struct Observer {
  Decided decided;  ///< called after each decision
  Moved moved;      ///< called after each step of the world
};
/// Deduces the types of the functions, which clang 14 does not do for an aggregate.
template <class Decided, class Moved>
Observer(Decided, Moved) -> Observer<Decided, Moved>;

}  // namespace slalom::evaluation
