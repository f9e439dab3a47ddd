// Races of several cars: grid, standings, contacts and who is at fault, overtakes, and that they repeat.
#include "slalom/evaluation/grid_race.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "evaluation/courses.hpp"
#include "evaluation/racing/race_watch.hpp"
#include "sim/rooms.hpp"

namespace slalom::evaluation {
namespace {

CarResult car_that(CarEnd end, double time, double progress, int grid_place) {
  return {.grid_place = grid_place, .end = end, .time = time, .progress = progress};
}

TEST(Standings, AreByTimeAndThenByDistance) {
  const std::vector<CarResult> cars{car_that(CarEnd::wall, 20, 55, 0), car_that(CarEnd::finished, 31, 60, 1),
                                    car_that(CarEnd::timeout, 90, 58, 2),
                                    car_that(CarEnd::finished, 30.5, 60, 3)};
  EXPECT_EQ(standings_of(cars), (std::vector<int>{3, 1, 2, 0}));
}

TEST(Standings, TheGridDecidesBetweenEquals) {
  const std::vector<CarResult> cars{car_that(CarEnd::finished, 30, 60, 1),
                                    car_that(CarEnd::finished, 30, 60, 0)};
  EXPECT_EQ(standings_of(cars), (std::vector<int>{1, 0}));
}

TEST(Poisson, TheIntervalIsThatOfGarwood) {
  const auto near = [](const Interval& interval, double low, double high) {
    EXPECT_NEAR(interval.low, low, 5e-4);
    EXPECT_NEAR(interval.high, high, 5e-4);
  };
  near(poisson_interval(0), 0, 3.6889);
  near(poisson_interval(1), 0.0253, 5.5716);
  near(poisson_interval(10), 4.7954, 18.3904);
  near(poisson_interval(100), 81.3640, 121.6268);
}

TEST(ContactRate, IsOverTheKilometresOfTheCars) {
  GridRaceResult race;
  race.cars.resize(2);
  race.cars[0].distance = 1500;
  race.cars[1].distance = 500;
  race.contacts = {{.cars = {0, 1}, .at_fault = 1}};
  const std::vector<GridRaceResult> races{race};
  const ContactRate all = contact_rate(races), first = contact_rate(races, 0),
                    second = contact_rate(races, 1);
  EXPECT_DOUBLE_EQ(all.kilometres, 2);
  EXPECT_DOUBLE_EQ(all.per_100_km, 50);
  EXPECT_NEAR(all.interval.high, 50 * 5.5716, 0.05);
  EXPECT_EQ(first.contacts, 1);
  EXPECT_EQ(first.caused, 0);
  EXPECT_DOUBLE_EQ(first.per_100_km, 0);
  EXPECT_DOUBLE_EQ(second.per_100_km, 200);
  EXPECT_TRUE(std::isnan(contact_rate({}).per_100_km));
}

/// Where a car starts (m beyond the line, m left of it) and how fast it drives.
struct CarRun {
  double from = 0, left = 0, speed = 0;
};

/// Watches cars that drive like this for `time` (s), with the line at arc length 0.
RaceWatch watch(const std::vector<CarRun>& drives, double time) {
  sim::World world({}, testing::ring_track());
  std::vector<maps::Pose> starts;
  for (const CarRun& drive : drives) {
    const sim::CarState state = on_ring(drive.from, drive.left, drive.speed);
    starts.push_back({state.x, state.y, state.yaw});
  }
  world.reset(1, starts);
  RaceWatch seen(world, 0);
  for (int k = 1; k * 0.01 <= time; ++k) {
    std::vector<sim::CarState> states;
    for (const CarRun& drive : drives)
      states.push_back(on_ring(drive.from + drive.speed * 0.01 * k, drive.left, drive.speed));
    world.follow(states);
    seen.update(world);
  }
  EXPECT_NEAR(seen.distance(world, 0), drives[0].from + drives[0].speed * time, 0.1);
  return seen;
}

TEST(RaceWatch, AnyCarCanOvertakeAnyOther) {
  const auto seen = watch({{0, 0.5, 2}, {-1, -0.5, 4}, {-2, 0.5, 2}}, 3);
  ASSERT_EQ(seen.overtakes().size(), 1U) << "a car that starts behind another has not been overtaken by it";
  EXPECT_EQ(seen.overtakes()[0].car, 1);
  EXPECT_EQ(seen.overtakes()[0].overtaken, 0);
  EXPECT_NEAR(seen.overtakes()[0].time, 1.0, 0.1) << "from 1 m behind to 1 m ahead";
  EXPECT_TRUE(seen.contacts().empty());
}

TEST(RaceWatch, ACarThatIsLappedIsNotOvertaken) {
  const auto seen = watch({{0, 0.5, 8}, {-1, -0.5, 2}}, 8);
  EXPECT_TRUE(seen.overtakes().empty()) << "the first leads all the time, by more than a lap in the end";
}

TEST(RaceWatch, TheCarBehindIsAtFaultWhicheverItIs) {
  const auto later = watch({{0, 0, 2}, {-3, 0, 4}, {-10, 0, 2}}, 2);
  ASSERT_EQ(later.contacts().size(), 1U);
  EXPECT_EQ(later.contacts()[0].cars, (std::array<int, 2>{0, 1}));
  EXPECT_EQ(later.contacts()[0].at_fault, 1);
  const auto earlier = watch({{-3, 0, 4}, {0, 0, 2}}, 2);
  ASSERT_EQ(earlier.contacts().size(), 1U);
  EXPECT_EQ(earlier.contacts()[0].at_fault, 0);
}

Driver entry(double max_speed = 100) {
  Driver made{configuration("default_kinematic", 64), "mppi"};
  made.configuration.planner.max_speed = max_speed;
  return made;
}

GridRace race_of(const std::vector<Driver>& entries, int laps = 1,
                 const LapSettings& settings = {.tracking = TrackingMode::exact}) {
  static const auto wren = course("wren");
  return {wren, entries, settings, laps};
}

std::vector<Driver> equals(std::size_t cars) {
  return std::vector<Driver>(cars, entry());
}

TEST(GridRace, FourEqualCarsRace) {
  const GridRace race = race_of(equals(4));
  ASSERT_EQ(race.grid().size(), 4U);
  int steps = 0, most = 0;
  double progress = 0;
  const GridRaceResult first = race.run(3, 1, [&](const GridRaceStep& step) {
    ++steps;
    most = std::max(most, step.driving);
    EXPECT_GE(step.progress, progress - 0.01);
    progress = step.progress;
    EXPECT_EQ(step.entry_of[0], 3) << "with a rotation of 1 the last car has the first place";
    EXPECT_EQ(step.world.observe(1).scan.ranges.size(), 1080U);
  });
  EXPECT_EQ(most, 4);
  EXPECT_NEAR(steps, first.time / race.control_period(), 2);
  ASSERT_TRUE(first.has_winner());
  std::vector<int> grid;
  for (const int car : first.standings) {
    const CarResult& result = first.cars[static_cast<std::size_t>(car)];
    grid.push_back(result.grid_place);
    EXPECT_EQ(first.standings[static_cast<std::size_t>(result.place)], car);
    EXPECT_GT(result.distance, 5);
    if (result.end != CarEnd::finished) continue;
    ASSERT_EQ(result.lap_times.size(), 1U);
    EXPECT_NEAR(result.lap_times[0], result.time, 1e-9) << "the first lap begins with the start";
    EXPECT_GE(result.gap, 0);
    EXPECT_NEAR(result.progress, race.lap_length(), 0.2);
    EXPECT_GT(result.distance, 0.8 * race.lap_length());
  }
  std::sort(grid.begin(), grid.end());
  EXPECT_EQ(grid, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(first.cars[0].grid_place, 1);
  int contacts = 0, caused = 0;
  for (const CarResult& car : first.cars) {
    contacts += car.contacts;
    caused += car.caused;
  }
  EXPECT_EQ(contacts, 2 * static_cast<int>(first.contacts.size()));
  EXPECT_EQ(caused, static_cast<int>(first.contacts.size()));
}

TEST(GridRace, TheFasterCarOvertakesOrFollowsAndEveryDriverHasItsOwnOptions) {
  const GridRace race = race_of({entry(1.0), entry()});
  EXPECT_NEAR(race.timeout(), race.lap(0).timeout(), 1e-9) << "that of the slower one";
  const GridRaceResult result = race.run(1, 1);
  EXPECT_EQ(result.cars[1].grid_place, 0) << "the faster car starts ahead";
  EXPECT_EQ(result.standings[0], 1);
  EXPECT_EQ(result.cars[1].end, CarEnd::finished);
  EXPECT_LT(result.cars[1].time, 0.8 * result.cars[0].time);
}

TEST(GridRace, ACarThatHitsAWallIsOutAndTheOthersGoOn) {
  Driver blind = entry();
  blind.configuration.planner.laser_yaw = 3;  // so that it knows walls where there are none
  blind.configuration.planner.stop_when_blocked = false;
  blind.configuration.planner.verify_plan = false;
  blind.configuration.planner.back_up = false;
  blind.configuration.planner.steer_limit = 0.02;  // rad
  const GridRaceResult result = race_of({entry(), blind}).run(2);
  EXPECT_EQ(result.cars[1].end, CarEnd::wall);
  EXPECT_TRUE(result.cars[1].lap_times.empty());
  EXPECT_TRUE(std::isnan(result.cars[1].gap));
  EXPECT_TRUE(std::isnan(result.cars[1].best_lap()));
  EXPECT_LT(result.cars[1].time, result.time);
  EXPECT_EQ(result.cars[0].end, CarEnd::finished);
  EXPECT_EQ(result.cars[0].place, 0);
}

TEST(GridRace, EndsWithWhatWasDrivenWhenItIsCancelled) {
  std::atomic<bool> cancel = false;
  int steps = 0;
  const GridRaceResult result = race_of(equals(2)).run(
      1, 0, [&](const GridRaceStep&) { cancel = ++steps == 40; }, &cancel);
  EXPECT_EQ(steps, 40);
  EXPECT_TRUE(result.cancelled);
  EXPECT_FALSE(result.has_winner());
  for (const CarResult& car : result.cars) {
    EXPECT_EQ(car.end, CarEnd::cancelled);
    EXPECT_GT(car.distance, 0.2);
  }
}

TEST(GridRace, RefusesWhatItCannotDrive) {
  EXPECT_THROW(race_of(equals(1)).validate(), std::invalid_argument);
  EXPECT_THROW(race_of(equals(5)).validate(), std::invalid_argument);
  EXPECT_THROW(race_of(equals(2), 0).validate(), std::invalid_argument);
  EXPECT_THROW(race_of(equals(2), 1, {.obstacles = 1}).validate(), std::invalid_argument);
  EXPECT_THROW(race_of(equals(2), 1, {.opponents = 1}).validate(), std::invalid_argument);
  EXPECT_THROW(race_of(equals(2), 1, {.rounds = 2}).validate(), std::invalid_argument);
  std::vector<Driver> periods = equals(2);
  periods[1].configuration.planner.control_period = 0.05;
  EXPECT_THROW(race_of(periods).validate(), std::invalid_argument);
}

}  // namespace
}  // namespace slalom::evaluation
