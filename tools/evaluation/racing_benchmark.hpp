#pragma once

#include <nlohmann/json_fwd.hpp>

#include "slalom/core/gravity.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/sim/racing_benchmark.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/racing/race_course.hpp"

/// The racing benchmark of Evans et al. (see sim::RacingBenchmark): its maps, laps and results.
namespace slalom::tools {

/// The maps, in the order of the published table.
inline constexpr const char* racing_maps[] = {"aut", "esp", "gbr", "mco"};
inline constexpr int racing_laps = 10;                ///< laps of each map
inline constexpr double racing_grip = 0.9 * gravity;  ///< m/s^2, with which a step is compared

/// A map of the benchmark with the centre line that its program uses.
struct RacingMap {
  std::string name{};
  maps::OccupancyGrid grid{};              ///< without unknown cells
  std::vector<maps::Point> centre_line{};  ///< m, without the first row of the file, which the program drops
};

/// Loads `folder/NAME/NAME.yaml` and `NAME_centerline.csv`, or both from `folder` itself. Throws IoError.
RacingMap load_racing_map(const std::filesystem::path& folder, const std::string& name);

/// The command for the next control period. A time that is not later than the last one means a new lap.
using RacingDriver = std::function<Command(const sim::RacingObservation& seen)>;

/// The driver by which the world is compared with the published one (sim::FollowTheGap).
RacingDriver make_gap_driver();

/// The path (closed) for a lap that starts and ends at `start`: `path`, led to the centre line there so that
/// the benchmark sees the end of the lap; empty if `path` itself will do. The benchmark looks for the car
/// between 99.5 and 99.9 % of a round, by the nearest row of the centre line. On the inside of a tight corner
/// no place is nearest to these rows, and a car that passes there drives another round.
std::optional<std::vector<maps::ReferencePoint>> path_through_finish(
    const std::vector<maps::ReferencePoint>& path, const std::vector<maps::Point>& centre_line,
    const maps::Point& start);

/// A planner of this library along the minimum-time line of a map for `car`, which leads through the end of
/// each lap (path_through_finish). The planner drives no faster than the car's top speed. Throws
/// std::invalid_argument where the map leaves no such line.
RacingDriver make_planner_driver(const RacingMap& map, const vehicle::Configuration& configuration,
                                 const std::string& method, const vehicle::RacingCar& car);

/// A lap as it ended.
struct BenchmarkLap {
  double time = 0;         ///< s
  bool completed = false;  ///< without a collision
  double progress = 0;     ///< share of the lap
  int steps = 0;           ///< time steps of the physics
  int beyond = 0;          ///< those with an acceleration above racing_grip
};

/// Drives the laps of a map.
std::vector<BenchmarkLap> drive_benchmark_laps(const RacingMap& map, const RacingDriver& driver, int laps);

/// `mean` (of completed laps, null without any), `completed`, `at_time_limit` (of the completed), `laps`,
/// `beyond_grip` (share of all steps), `lap_times` (null for a collision).
nlohmann::ordered_json racing_results(const std::vector<BenchmarkLap>& laps);

}  // namespace slalom::tools
