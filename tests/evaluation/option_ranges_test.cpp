// Options of maps, simulator, tracker and vehicle: each value out of its declared range is refused by name.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/rooms.hpp"
#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/maps/reference_field.hpp"
#include "slalom/sim/imu.hpp"
#include "slalom/sim/wheel_odometry.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/tracking/object_tracker.hpp"
#include "slalom/tracking/predictor.hpp"
#include "slalom/vehicle/localisation/localiser.hpp"
#include "slalom/vehicle/model/vehicle_model.hpp"
#include "support/thrown_words.hpp"

namespace slalom::option_ranges_test {
namespace {

/// Values beside a range, which has no bound beyond 1e9.
std::vector<double> values_beside(const Declaration& declared) {
  std::vector<double> values;
  if (declared.min > -1e9) values.push_back(declared.min - 1);
  if (declared.max < 1e9) values.push_back(declared.max + 1);
  return values;
}

/// Sets one option after another to values beside its range; `make` takes the options.
template <class Options, class Make>
void expect_ranges_are_kept(const Make& make) {
  int refused = 0;
  const auto expect_refusal = [&](const Options& options, const Declaration& declared, double value) {
    const std::string message = message_of([&] { make(options); });
    EXPECT_NE(message.find(declared.name), std::string::npos)
        << declared.name << " " << value << ": " << message;
    ++refused;
  };
  Options options;
  visit_options(options, [&](auto& option, const Declaration& declared) {
    using Value = std::remove_cvref_t<decltype(option)>;
    const Value usual = option;
    if constexpr (std::is_same_v<Value, double> || std::is_same_v<Value, int>) {
      std::vector<double> values = values_beside(declared);
      if (std::is_same_v<Value, double>) values.push_back(NAN);
      for (const double value : values) {
        option = static_cast<Value>(value);
        expect_refusal(options, declared, value);
      }
      option = usual;
    }
  });
  EXPECT_GT(refused, 0);
}

TEST(OptionRanges, OfMapsAreKept) {
  const std::vector<maps::ReferencePoint> path{{0, 0, 0, 1}, {1, 0, 0, 1}, {1, 1, 0, 1}};
  expect_ranges_are_kept<maps::LocalCostMapOptions>([](const auto& o) { maps::LocalCostMap{o}; });
  expect_ranges_are_kept<maps::ClearanceMapOptions>([](const auto& o) { maps::ClearanceMap{o}; });
  expect_ranges_are_kept<maps::ReferenceFieldOptions>([&](const auto& o) { maps::ReferenceField(path, o); });
  expect_ranges_are_kept<maps::MovingObstacleOptions>([](const auto& o) { maps::MovingObstacles(o, 1); });
  EXPECT_THROW(maps::MovingObstacles({}, 0), std::invalid_argument);
}

TEST(OptionRanges, OfTheSimulatorAreKept) {
  const auto track = testing::ring_track();
  expect_ranges_are_kept<sim::WorldOptions>([&](const auto& o) { sim::World(o, track); });
  expect_ranges_are_kept<sim::LidarOptions>([&](const auto& o) { sim::World({.lidar = o}, track); });
  expect_ranges_are_kept<sim::CarParameters>([&](const auto& o) { sim::World({.car = o}, track); });
  expect_ranges_are_kept<sim::PlantOptions>([&](const auto& o) { sim::World({.plant = o}, track); });
  expect_ranges_are_kept<sim::ImuOptions>([](const auto& o) { sim::Imu{o}; });
  expect_ranges_are_kept<sim::WheelOdometryOptions>([](const auto& o) { sim::WheelOdometry({}, o); });
  EXPECT_THROW(sim::World({}, nullptr), std::invalid_argument);
  sim::CarParameters light{.inertia = 1e-9};
  expect_error_with<std::invalid_argument>({"parts of a step"}, [&] { sim::World({.car = light}, track); });
}

TEST(OptionRanges, OfTrackerLocaliserAndVehicleAreKept) {
  const maps::OccupancyGrid map = testing::room(40, 40);
  expect_ranges_are_kept<tracking::TrackerOptions>([](const auto& o) { tracking::ObjectTracker{o}; });
  expect_ranges_are_kept<tracking::PredictorOptions>([](const auto& o) { tracking::Predictor{o}; });
  expect_ranges_are_kept<vehicle::LocaliserOptions>([&](const auto& o) { vehicle::Localiser(map, o); });
  expect_ranges_are_kept<vehicle::VehicleOptions>([](const auto& o) { vehicle::make_vehicle_model(o); });
  EXPECT_NE(message_of([&] {
              vehicle::Localiser(map, {.min_particles = 900, .max_particles = 800});
            }).find("min_particles"),
            std::string::npos);
}

}  // namespace
}  // namespace slalom::option_ranges_test
