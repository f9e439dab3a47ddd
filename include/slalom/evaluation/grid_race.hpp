#pragma once

#include "slalom/evaluation/lap.hpp"
#include "slalom/evaluation/lap_figures.hpp"
#include "slalom/evaluation/statistics.hpp"

namespace slalom::evaluation {

/// Most cars of a race.
inline constexpr int most_race_cars = 4;

/// How a race ended for a car.
enum class CarEnd {
  finished,   ///< it drove all laps
  wall,       ///< it hit a wall
  timeout,    ///< it did not drive all laps in time
  cancelled,  ///< the race was ended by the caller; in results "interrupted"
};
/// The name of an end in results.
std::string_view name(CarEnd end) noexcept;

/// Two cars collide that have not collided for 0.5 s. OvertakingRecord has the rule of who is at fault.
struct CarContact {
  double time = 0;            ///< s
  std::array<int, 2> cars{};  ///< indices of entries
  int at_fault = 0;           ///< one of these
  maps::Pose pose{};          ///< pose of the first car's centre of gravity
};

/// A car overtakes another when it comes to be 1 m ahead of it, from middle to middle, and the other was 1 m
/// ahead before, or in front of it on the grid. What counts is the progress over all laps: to lap a car, or
/// to pass one that has left the track, is not to overtake it.
struct Overtake {
  double time = 0;    ///< s
  int car = 0;        ///< index of its entry
  int overtaken = 0;  ///< index of the other's
};

/// A car of a race that has ended.
struct CarResult {
  int place = 0;                        ///< in the standings, from 0
  int grid_place = 0;                   ///< at the start, from 0
  CarEnd end = CarEnd::timeout;         ///< how the race ended for it
  double time = 0;                      ///< s since the start, when it ended
  double gap = 0;                       ///< s behind the winner; NaN unless finished
  std::vector<double> lap_times{};      ///< s, of whole laps; the first begins with the start
  double distance = 0;                  ///< m, driven
  double progress = 0;                  ///< m along the course beyond the finish line
  int overtakes = 0;                    ///< number of cars that it overtook
  int overtaken = 0;                    ///< by other cars
  int contacts = 0;                     ///< with other cars
  int caused = 0;                       ///< those of them at which it is at fault
  bool contact_before = false;          ///< with CarEnd::wall: it collided with a car in the second before
  maps::Pose last{};                    ///< pose of its centre of gravity where it ended
  std::array<int, 7> planner_status{};  ///< control steps by vehicle::PlannerStatus
  std::vector<float> solve_ms{};        ///< wall-clock time of each solve

  double best_lap() const noexcept;  ///< s; NaN without a whole lap
};

/// Calls `visit(value, Figure)` for every figure of a car in the order of tables.
template <class Visit>
void visit_figures(const CarResult& car, Visit&& visit) {
  visit(car.place + 1, Figure{"place", "", "in the standings, from 1"});
  visit(car.grid_place + 1, Figure{"grid_place", "", "at the start, from 1"});
  visit(static_cast<int>(car.lap_times.size()), Figure{"laps", "", "whole laps"});
  visit(car.time, Figure{"time", "s", "from the start until the race ended for the car"});
  visit(car.gap, Figure{"gap", "s", "behind the winner, of a car that finished"});
  visit(car.best_lap(), Figure{"best_lap", "s", "time of the best whole lap"});
  visit(car.lap_times, Figure{"lap_times", "s", "times of the whole laps; the first begins with the start"});
  visit(car.progress, Figure{"progress", "m", "along the course beyond the finish line"});
  visit(car.distance, Figure{"distance", "m", "distance driven"});
  visit(car.overtakes, Figure{"overtakes", "", "cars that it overtook"});
  visit(car.overtaken, Figure{"overtaken", "", "times that it was overtaken"});
  visit(car.contacts, Figure{"contacts", "", "contacts with other cars"});
  visit(car.caused, Figure{"contacts_caused", "", "those of them at which it is at fault"});
}

/// A race that has ended.
struct GridRaceResult {
  std::uint64_t seed = 0;            ///< seed of the random numbers
  bool cancelled = false;            ///< ended by the caller
  double time = 0;                   ///< s, when it ended
  std::vector<CarResult> cars;       ///< results in the order of the entries
  std::vector<int> standings;        ///< indices of the entries, the winner first
  std::vector<CarContact> contacts;  ///< in order of time
  std::vector<Overtake> overtakes;   ///< in order of time

  /// Whether a car has finished.
  bool has_winner() const noexcept;
};

/// A control step of a race, before the drivers decide. The references are valid until the callback returns.
struct GridRaceStep {
  double time = 0;                ///< s
  double progress = 0;            ///< share of the race that the first car has driven
  int contacts = 0;               ///< so far
  int driving = 0;                ///< cars on the track
  const sim::World& world;        ///< the simulated world; its cars are numbered by their place on the grid
  std::span<const int> entry_of;  ///< index of the entry of each car of the world
};
/// Function that is called in every control step.
using GridRaceCallback = std::function<void(const GridRaceStep&)>;

/// Races of several cars on a closed course, each with a planner, a LiDAR that sees the others, and, with
/// LapSettings::tracking, a tracker and predictor of its own. All random numbers follow from the seed.
///
/// The cars stand on a grid behind the start of the course, 1 m apart along its line and 0.25 m to the left
/// and to the right of it in turn, less where a wall is near, and start together. A lap ends at the first
/// place's arc length, for all cars. A car that has driven its laps, and one that hits a wall, leaves the
/// track at once. After a contact both cars go on; the one that was driven into keeps its motion. The race
/// ends when no car is left on the track, or after the longest timeout of a lap of its cars
/// (LapSetup::timeout) times the laps. Standings: cars that finished, by time, then the others, by how far
/// they came.
struct GridRace {
  std::shared_ptr<const Environment> environment;  ///< course of the race
  std::vector<Driver> drivers;                     ///< drivers of the entries, two to `most_race_cars`
  LapSettings settings{};                          ///< without obstacles, opponents or further rounds
  int laps = 5;                                    ///< laps of each car, [1, 1000]

  /// Throws std::invalid_argument as LapSetup::validate does for each driver, and on a course that is not
  /// closed, another protocol than Protocol::true_physics, control periods that differ, and settings and
  /// laps out of range.
  void validate() const;

  /// Drives a race. Entry i starts from place (i + `rotation`) of the grid, modulo the number of cars. Ends
  /// early when `cancel` becomes true. Throws std::invalid_argument as `validate` does for drivers, and
  /// std::runtime_error if the course has no room for the grid.
  GridRaceResult run(std::uint64_t seed, int rotation = 0, const GridRaceCallback& on_step = {},
                     const std::atomic<bool>* cancel = nullptr) const;

  /// The lap of one entry on its own.
  LapSetup lap(std::size_t entry) const { return {environment, drivers[entry], settings}; }
  /// The places of the grid: centres of gravity. Throws std::runtime_error if the course has no room for it.
  std::vector<maps::Pose> grid() const;
  double timeout() const;                                                     ///< s
  double lap_length() const { return lap(0).length(); }                       ///< m
  double control_period() const noexcept { return lap(0).control_period(); }  ///< s
};

/// The indices of cars in the order of the standings: those that finished by time, then the others by their
/// progress. The grid decides between equals.
std::vector<int> standings_of(std::span<const CarResult> cars);

/// Contacts over the distance that was driven.
struct ContactRate {
  int contacts = 0;       ///< contacts of the car, or of all cars
  int caused = 0;         ///< those of them at which it was at fault; of all cars: every one
  double kilometres = 0;  ///< driven
  double per_100_km = 0;  ///< caused; NaN without a distance
  Interval interval;      ///< 95 % interval of the rate (poisson_interval)
};
/// Calls `visit(value, Figure)` for every figure of a rate in the order of tables.
template <class Visit>
void visit_figures(const ContactRate& rate, Visit&& visit) {
  visit(rate.contacts, Figure{"contacts", "", "contacts with other cars"});
  visit(rate.caused, Figure{"contacts_caused", "", "those of them at which the car is at fault"});
  visit(rate.kilometres, Figure{"driven", "km", "distance driven in all races"});
  visit(rate.per_100_km, Figure{"caused_per_100_km", "", "contacts caused in 100 km"});
}
/// Returns the rate of the car of one entry, or of all cars together for -1, over several races.
ContactRate contact_rate(std::span<const GridRaceResult> races, int entry = -1);

}  // namespace slalom::evaluation
