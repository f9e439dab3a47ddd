#include "tools/evaluation/racing_benchmark.hpp"

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/evaluation/drive.hpp"
#include "slalom/maps/ros_map.hpp"
#include "slalom/sim/follow_the_gap.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;

/// Drives with a planner of this library.
class PlannerDriver {
 public:
  using Path = std::vector<maps::ReferencePoint>;
  using MakePlanner = std::function<vehicle::Planner(const Path&)>;

  PlannerDriver(Path path, std::vector<maps::Point> centre_line, MakePlanner make,
                const sim::CarParameters& car, const sim::LidarOptions& lidar)
      : path_(std::move(path)),
        centre_line_(std::move(centre_line)),
        make_(std::move(make)),
        planner_(make_(path_)),
        car_(car),
        lidar_(lidar) {}

  Command operator()(const sim::RacingObservation& seen) {
    const sim::CarState& state = seen.state;
    if (laps_ == 0 || seen.time <= time_) begin_lap({state.x, state.y});
    time_ = seen.time;
    ranges_.assign(seen.scan.begin(), seen.scan.end());
    const maps::Pose body{state.x, state.y, maps::wrap_angle(state.yaw)};
    const maps::Point axle = maps::transform(body, {-car_.rear_length, 0});
    const maps::LaserScanView scan{ranges_, lidar_.angle_min(), lidar_.angle_increment(), 0,
                                   lidar_.range_max};
    vehicle::Planner& planner = of_this_lap_ ? *of_this_lap_ : planner_;
    return planner.update({.scan = scan, .odometry = {{axle.x, axle.y, body.yaw}, state.speed}}).command;
  }

 private:
  void begin_lap(const maps::Point& start) {
    const std::uint64_t lap = laps_++;
    of_this_lap_.reset();
    if (const auto path = path_through_finish(path_, centre_line_, start)) of_this_lap_.emplace(make_(*path));
    if (lap > 0) (of_this_lap_ ? *of_this_lap_ : planner_).reset(lap);
  }

  Path path_;
  std::vector<maps::Point> centre_line_;
  MakePlanner make_;
  vehicle::Planner planner_;
  std::optional<vehicle::Planner> of_this_lap_;  ///< where the path leads through the end of the lap
  sim::CarParameters car_;
  sim::LidarOptions lidar_;
  std::vector<float> ranges_;
  double time_ = 0;
  std::uint64_t laps_ = 0;
};

/// A driver in the loop; a step of the world is a control period.
struct DriverOfWorld {
  const RacingDriver& driver;
  Command decided{};
  const Command& decide(const sim::RacingBenchmark& world) { return decided = driver(world.observation()); }
  Command command(const sim::RacingBenchmark&) const { return decided; }
  void moved(const sim::RacingBenchmark&) const {}
};

maps::Point place(const maps::ReferencePoint& point) {
  return {point.x, point.y};
}

template <class Points>
std::size_t nearest(const Points& points, const maps::Point& to) {
  const auto away = [&to](const auto& point) { return distance({point.x, point.y}, to); };
  return static_cast<std::size_t>(
      std::min_element(points.begin(), points.end(),
                       [&](const auto& a, const auto& b) { return away(a) < away(b); }) -
      points.begin());
}

/// m of a closed path on which the benchmark sees the end of a lap that started at this progress.
double seen_way(const std::vector<maps::ReferencePoint>& path, const sim::BenchmarkLine& line, double start) {
  constexpr double step = 0.02;     // m
  constexpr double window = 0.004;  // share of a round: 99.5 to 99.9 %; progress is up to a row late
  double seen = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const maps::Point a = place(path[i]), b = place(path[(i + 1) % path.size()]);
    const int pieces = static_cast<int>(std::ceil(distance(a, b) / step));
    for (int k = 0; k < pieces; ++k) {
      const double share = (k + 0.5) / pieces;
      const double left = start - line.progress({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)});
      if (left - std::floor(left) < window) seen += distance(a, b) / pieces;
    }
  }
  return seen;
}

}  // namespace

RacingMap load_racing_map(const fs::path& folder, const std::string& name) {
  const fs::path own = folder / name, from = fs::is_directory(own) ? own : folder;
  RacingMap map{.name = name,
                .grid = maps::load_ros_map(from / (name + ".yaml"), maps::MapRule::grey_threshold)};
  const fs::path file = from / (name + "_centerline.csv");
  map.centre_line = vehicle::read_centre_line(file).line.points;
  map.centre_line.erase(map.centre_line.begin());
  return map;
}

RacingDriver make_gap_driver() {
  return [driver = sim::FollowTheGap()](const sim::RacingObservation& seen) mutable {
    return driver.command(seen.scan);
  };
}

std::optional<std::vector<maps::ReferencePoint>> path_through_finish(
    const std::vector<maps::ReferencePoint>& path, const std::vector<maps::Point>& centre_line,
    const maps::Point& start) {
  constexpr double reach = 4;    // m along the centre line, from the start to where the path is left alone
  constexpr double least = 0.2;  // m to be seen on; a car that turns tightly drives less in a control period
  const sim::BenchmarkLine line(centre_line);
  if (seen_way(path, line, line.progress(start)) >= least) return std::nullopt;
  const std::size_t rows = centre_line.size(), middle = nearest(centre_line, start);
  const auto row_at = [&](double way, std::size_t step) {
    std::size_t row = middle;
    double away = 0;
    for (std::size_t k = 0; k < rows && away < way; ++k, row = (row + step) % rows)
      away += distance(centre_line[row], centre_line[(row + step) % rows]);
    return row;
  };
  // The centre line's rows replace the path's points: on the inside of the corner those have no row each.
  const std::size_t first = row_at(reach, rows - 1), count = (row_at(reach, 1) + rows - first) % rows + 1;
  std::vector<maps::ReferencePoint> led;
  std::size_t from = 0, to = 0;  // points of the path nearest to the first and the last of the rows
  for (std::size_t k = 0; k < count; ++k) {
    const maps::Point& row = centre_line[(first + k) % rows];
    to = nearest(path, row);
    if (k == 0) from = to;
    const double share =
        0.5 - 0.5 * std::cos(2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count - 1));
    led.push_back({path[to].x + share * (row.x - path[to].x), path[to].y + share * (row.y - path[to].y),
                   path[to].yaw, path[to].speed});
  }
  for (std::size_t i = (to + 1) % path.size(); i != from; i = (i + 1) % path.size()) led.push_back(path[i]);
  for (std::size_t i = 0; i < count; ++i) {
    const auto &before = led[(i + led.size() - 1) % led.size()], &after = led[(i + 1) % led.size()];
    led[i].yaw = std::atan2(after.y - before.y, after.x - before.x);
  }
  return led;
}

RacingDriver make_planner_driver(const RacingMap& map, const vehicle::Configuration& configuration,
                                 const std::string& method, const vehicle::RacingCar& car) {
  const vehicle::RaceCourse course = vehicle::race_course(map.grid, car);
  std::vector<maps::ReferencePoint> path;
  for (const vehicle::RacelinePoint& point : course.raceline.points)
    path.push_back({point.x, point.y, point.yaw, point.speed});
  const sim::CarParameters simulated;
  const sim::LidarOptions lidar;
  vehicle::PlannerOptions options = configuration.planner;
  options.control_period = sim::RacingBenchmark::time_step * sim::RacingBenchmark::steps_per_command;
  options.max_speed = std::min(options.max_speed, car.limits.top_speed);
  options.laser_x = simulated.rear_length;
  const auto make = [=](const std::vector<maps::ReferencePoint>& along) {
    return vehicle::Planner(options, vehicle::make_vehicle_model(configuration.vehicle), along,
                            vehicle::make_solver(configuration, method, 1));
  };
  return PlannerDriver(std::move(path), map.centre_line, make, simulated, lidar);
}

std::vector<BenchmarkLap> drive_benchmark_laps(const RacingMap& map, const RacingDriver& driver, int laps) {
  evaluation::Drive<sim::RacingBenchmark, DriverOfWorld> drive{
      {std::make_shared<const sim::Track>(map.grid), map.centre_line}, {{driver}}};
  sim::RacingBenchmark& world = drive.world;
  evaluation::Observer observer{[](std::size_t, const Command&) {},
                                [](const sim::RacingBenchmark&) { return true; }};
  std::vector<BenchmarkLap> driven;
  for (int k = 0; k < laps; ++k) {
    world.reset();
    while (!world.collided() && !world.complete()) drive.step(observer);
    BenchmarkLap lap{world.time(), !world.collided(), world.observation().progress, 0, 0};
    for (const double acceleration : world.accelerations()) {
      ++lap.steps;
      lap.beyond += acceleration > racing_grip;
    }
    driven.push_back(lap);
  }
  return driven;
}

Json racing_results(const std::vector<BenchmarkLap>& laps) {
  double sum = 0;
  int completed = 0, at_limit = 0;
  long long steps = 0, beyond = 0;
  Json times = Json::array();
  for (const BenchmarkLap& lap : laps) {
    steps += lap.steps;
    beyond += lap.beyond;
    times.push_back(lap.completed ? Json(lap.time) : Json(nullptr));
    if (!lap.completed) continue;
    sum += lap.time;
    ++completed;
    at_limit += lap.time > sim::RacingBenchmark::max_time;
  }
  return {{"mean", completed > 0 ? Json(sum / completed) : Json(nullptr)},
          {"completed", completed},
          {"at_time_limit", at_limit},
          {"laps", static_cast<int>(laps.size())},
          {"beyond_grip", steps > 0 ? static_cast<double>(beyond) / static_cast<double>(steps) : 0.0},
          {"lap_times", times}};
}

}  // namespace slalom::tools
