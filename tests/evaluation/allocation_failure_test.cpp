// Memory that runs out at any allocation of a planner, a course, or the start of a lap, a race or a drive in
// a room: std::bad_alloc, and nothing is lost.

#include "evaluation/courses.hpp"
#include "slalom/evaluation/grid_race.hpp"
#include "slalom/evaluation/rooms/room_drive.hpp"
#include "support/allocation_failures.hpp"
#include "vehicle/planner/planner_calls.hpp"

namespace slalom::evaluation {
namespace {

TEST(AllocationFailure, EveryPlannerIsMadeOrThrowsAndThenPlans) {
  const auto path = testing::lane(3);
  const std::vector<float> ranges(271, 10);
  for (int model = 0; model < static_cast<int>(vehicle::VehicleModels::size); ++model)
    for (const char* method : solver_names()) {
      SCOPED_TRACE("model " + std::to_string(model) + ", " + method);
      vehicle::VehicleOptions car;
      car.model = vehicle::VehicleModelId{model};
      EXPECT_GT(testing::fail_every_allocation([&] {
                  vehicle::Planner planner(
                      {}, vehicle::make_vehicle_model(car), path,
                      make_solver(testing::few_samples(method), vehicle::input_count(car)));
                  return planner.update({{ranges, -2.35, 4.7 / 270, 0.05, 30}, {{5, 0, 0}, 2}}).command.steer;
                }),
                20);
    }
}

TEST(AllocationFailure, ACourseIsLoadedOrThrows) {
  EXPECT_GT(testing::fail_every_allocation([&] { return course("wren")->path.size(); }, 50), 100);
}

/// Starts a lap with few samples. The setup is filled field by field: g++ 12 destroys fields of a nested
/// aggregate twice if the copy of a later one throws.
double start_of_lap(const std::shared_ptr<const Environment>& environment,
                    const vehicle::Configuration& configuration, const LapSettings& settings) {
  LapSetup setup;
  setup.environment = environment;
  setup.driver.configuration = configuration;
  setup.settings = settings;
  LapDrive drive(setup, 5);
  for (int step = 0; step < 2; ++step) drive.step();
  return drive.world().state(0).x;
}

TEST(AllocationFailure, ALapStartsOrThrows) {
  const auto environment = course("wren");
  vehicle::Configuration configuration;
  vehicle::set_option(configuration, "samples", "40", "svg_mppi");
  const LapSettings among_obstacles{.obstacles = 2};
  const LapSettings behind_another{.opponents = 1, .opponent_gap = 3, .tracking = TrackingMode::exact};
  for (const LapSettings& settings : {among_obstacles, behind_another}) {
    SCOPED_TRACE(std::to_string(settings.opponents) + " opponents");
    EXPECT_GT(testing::fail_every_allocation(
                  [&] { return start_of_lap(environment, configuration, settings); }, 50),
              100);
  }
  const LapSettings behind_a_planner{
      .opponents = 1, .planning_opponents = 1, .opponent_gap = 3, .tracking = TrackingMode::exact};
  EXPECT_GT(testing::fail_every_allocation(
                [&] { return start_of_lap(environment, configuration, behind_a_planner); }, 50),
            100);
}

TEST(AllocationFailure, ARaceAmongCarsStartsOrThrows) {
  const auto environment = course("wren");
  vehicle::Configuration configuration;
  vehicle::set_option(configuration, "samples", "40", "mppi");
  const std::vector<Driver> drivers(2, {configuration, "mppi"});
  EXPECT_GT(testing::fail_every_allocation(
                [&] {
                  const GridRace race{environment, drivers, {.tracking = TrackingMode::exact}, 1};
                  std::atomic<bool> cancel{false};
                  const GridRaceResult result = race.run(
                      3, 0, [&](const GridRaceStep& step) { cancel = step.time > 0.03; }, &cancel);
                  return result.cars[0].last.x + result.cars[1].last.yaw;
                },
                50),
            100);
}

TEST(AllocationFailure, ADriveInARoomStartsOrThrows) {
  RoomDriver driver;
  SvgMppiOptions options = navigation::svg_mppi_options({});
  options.samples = 32;
  driver.solver = options;
  const RoomScenario& scenario = room_scenario("oncoming-walker");
  EXPECT_GT(
      testing::fail_every_allocation([&] { return drive_room(scenario, driver, 3, 0.2).trace.back().x; }, 50),
      100);
}

}  // namespace
}  // namespace slalom::evaluation
