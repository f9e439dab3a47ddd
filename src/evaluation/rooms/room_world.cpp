#include "slalom/evaluation/rooms/room_world.hpp"

#include <chrono>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/maps/laser_scan.hpp"

namespace slalom::evaluation {
namespace {

/// Varies the walkers of a scenario with the seed.
std::vector<sim::Walker> varied(std::vector<sim::Walker> walkers, std::uint64_t seed) {
  constexpr double spread = 0.1, longest_pause = 1;  // share of the speed, s: largest changes
  RandomStream random({seed, 1});
  for (sim::Walker& each : walkers) {
    each.speed *= 1 + random.uniform(-spread, spread);
    each.pause += random.uniform(0, longest_pause);
  }
  return walkers;
}

/// A navigator for this base.
navigation::NavigatorOptions with_base(navigation::NavigatorOptions options,
                                       const navigation::BaseOptions& base) {
  options.base = base;
  return options;
}

}  // namespace

maps::Pose varied(const maps::Pose& start, RandomStream& random) {
  constexpr double start_spread = 0.03, start_turn = 0.1;  // m along each axis, rad: largest changes
  const auto spread = [&](double most) { return random.uniform(-most, most); };
  return {start.x + spread(start_spread), start.y + spread(start_spread), start.yaw + spread(start_turn)};
}

RoomScenario with_heading(RoomScenario scenario, std::uint64_t seed) {
  constexpr double pi = std::numbers::pi;
  if (scenario.any_heading) scenario.goal.yaw = RandomStream({seed, 2}).uniform(-pi, pi);
  return scenario;
}

SolverOptions with_seed(SolverOptions solver, std::uint64_t seed) {
  std::uint64_t* const solver_seed = solver.find<std::uint64_t>("seed");
  if (!solver_seed)
    throw std::invalid_argument("method " + std::string(solver.method()) +
                                ": must have the option seed of type std::uint64_t");
  *solver_seed = seed;
  return solver;
}

RoomWorld::RoomWorld(const RoomScenario& scenario, std::uint64_t seed, const maps::Pose& start)
    : pose(start),
      room_(scenario.room),
      crowd_(room_, varied(scenario.walkers, seed)),
      body_{{}, scenario.robot_length, scenario.robot_width},
      lag_(scenario.lag),
      late_(saturate_cast<std::size_t>(std::round(scenario.delay * parts / room_period))) {
  room_.people.assign(crowd_.bodies().begin(), crowd_.bodies().end());
}

void RoomWorld::step(std::span<const navigation::Velocity> commands) {
  late_.push_back(commands[0]);
  const double dt = room_period / parts, share = lag_ > 0 ? 1 - std::exp(-dt / lag_) : 1;
  const navigation::Velocity& asked = late_.front();
  velocity = {velocity.forward + share * (asked.forward - velocity.forward),
              velocity.left + share * (asked.left - velocity.left),
              velocity.turn + share * (asked.turn - velocity.turn)};
  late_.pop_front();
  const maps::Pose before = std::exchange(pose, navigation::moved(pose, velocity, dt));
  if (!room_.people.empty()) {
    crowd_.step(dt, {pose, body_.length, body_.width}, {(pose.x - before.x) / dt, (pose.y - before.y) / dt});
    room_.people.assign(crowd_.bodies().begin(), crowd_.bodies().end());
  }
  collided = collided || collides();
}

void RoomWorld::move_obstacle(std::size_t index, const maps::Point& to) {
  const std::size_t boxes = room_.obstacles.size();
  if (index < boxes)
    room_.obstacles[index].pose = {to.x, to.y, room_.obstacles[index].pose.yaw};
  else
    room_.posts.at(index - boxes).middle = to;
  crowd_.set_obstacles(room_);
}

maps::Point RoomWorld::counted() const {
  if (!room_.obstacles.empty()) return {room_.obstacles[0].pose.x, room_.obstacles[0].pose.y};
  return room_.people.empty() ? maps::Point{1e6, 1e6} : room_.people[0].middle;
}

RoomNavigator::RoomNavigator(const RoomScenario& scenario, const RoomDriver& driver, std::uint64_t seed,
                             const RandomStream& random)
    : random_(random),
      ranges_(static_cast<std::size_t>(scenario.beams)),
      half_view_(0.5 * scenario.view),
      body_(navigation::Footprint::rectangle(0.5 * scenario.robot_length + scenario.padding,
                                             0.5 * scenario.robot_length + scenario.padding,
                                             scenario.robot_width + 2 * scenario.padding)),
      predicts_(driver.predict_movers),
      goal_(scenario.goal),
      given_(scenario.path),
      stands_(scenario.odometry_stands),
      watch_(ranges_.size()),
      map_(sim::map_of(scenario.room, resolution)),
      costmap_(map_.grid().width, map_.grid().height, resolution),
      navigator_((costmap_.update(map_.grid()), body_), with_base(driver.navigator, scenario.base),
                 with_seed(driver.solver, seed), costmap_) {}

bool RoomNavigator::set_path(const maps::Pose& from) {
  path = given_.empty() ? path_from(from) : given_;
  if (!path.empty()) navigator_.set_path(path);
  return !path.empty();
}

bool RoomNavigator::set_goal(const maps::Pose& goal, const maps::Pose& from) {
  const std::vector<maps::Pose> way = plan_path(costmap_, body_, from, goal);
  if (way.empty()) return false;
  goal_ = goal;
  given_.clear();
  path = way;
  navigator_.set_path(path);
  return true;
}

void RoomNavigator::replace(const navigation::NavigatorOptions& options, const SolverOptions& solver) {
  navigator_ = navigation::Navigator(body_, options, solver, costmap_);
  navigator_.set_path(path);
}

navigation::NavigationResult RoomNavigator::decide(const RoomWorld& world, double elapsed) {
  sim::scan(world.room(), world.pose, max_range, ranges_);
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    double& range = ranges_[i];
    if (range < max_range) range = std::max(range + range_noise * random_.normal(), 0.0);
    if (std::abs(maps::wrap_angle(maps::beam_angle(i, ranges_.size()))) > half_view_) range = unseen;
  }
  const navigation::RangeScan scan{world.pose, ranges_, max_range};
  std::span<const maps::PredictedObstacle> others;
  if (predicts_) others = watch_.update(scan, world.time);
  map_.add(predicts_ ? watch_.without_movers() : scan);
  costmap_.update(map_.grid());
  const auto begin = std::chrono::steady_clock::now();
  const auto result = navigator_.update(world.pose, stands_ ? navigation::Velocity{} : world.velocity,
                                        costmap_, elapsed, others);
  update_times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  command_ = result.command;
  return result;
}

}  // namespace slalom::evaluation
