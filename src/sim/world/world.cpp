#include "slalom/sim/world.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "sim/validation.hpp"

namespace slalom::sim {
namespace {

maps::Pose pose_of(const CarState& state) {
  return {state.x, state.y, state.yaw};
}

void require_finite(const char* name, const maps::Pose& pose) {
  if (!std::isfinite(pose.x) || !std::isfinite(pose.y) || !std::isfinite(pose.yaw))
    throw std::invalid_argument(std::string(name) + ": x, y and yaw must be finite");
}

void require_finite(const CarState& state) {
  require_finite("state", pose_of(state));
  for (const double value : {state.steer, state.speed, state.yaw_rate, state.slip})
    if (!std::isfinite(value))
      throw std::invalid_argument("state: steer, speed, yaw_rate and slip must be finite");
}

std::shared_ptr<const Track> present(std::shared_ptr<const Track> track) {
  if (!track) throw std::invalid_argument("track: must not be null");
  return track;
}

const WorldOptions& validated(const WorldOptions& options) {
  options.validate();
  return options;
}

}  // namespace

WorldOptions WorldOptions::gym_compatible() {
  WorldOptions o;
  o.plant.dynamics.substeps = 1;
  o.plant.dynamics.gym = GymDynamics::all();
  o.plant.actuation.gym = GymActuation::all();
  o.plant.gym = GymPlant::all();
  o.lidar.mount = {};
  o.lidar.gym = GymLidar::all();
  o.body_response = CollisionResponse::count_only;
  o.start_anywhere = true;
  o.gym = GymWorld::all();
  return o;
}

void WorldOptions::validate() const {
  detail::require_range("time_step", time_step, 1e-5, 0.1);
  car.validate();
  // The plant checks its options when it is made.
  [[maybe_unused]] const Plant checked(car, plant, time_step);
  lidar.validate();
  detail::require_range("sectors", sectors, 1, 1000);
  if (gym.wall_collision && lidar.rate > 0 && std::lround(1 / (lidar.rate * time_step)) > 1)
    throw std::invalid_argument("gym.wall_collision: needs a scan in every step, so rate must be 0");
}

World::World(const WorldOptions& options, std::shared_ptr<const Track> track)
    : options_(validated(options)),
      track_(present(std::move(track))),
      lidar_(options.lidar),
      time_to_collision_(options.lidar, options.car) {
  if (options.lidar.rate > 0)
    scan_every_ = std::max<std::int64_t>(1, std::lround(1 / (options.lidar.rate * options.time_step)));
}

void World::reset(std::uint64_t seed, std::span<const maps::Pose> cars, std::span<const maps::Pose> parked) {
  for (const maps::Pose& pose : cars) require_finite("start of a driven car", pose);
  for (const maps::Pose& pose : parked) require_finite("pose of a parked car", pose);
  const std::size_t beams = static_cast<std::size_t>(options_.lidar.beams);
  time_ = 0;
  steps_ = 0;
  fixed_.clear();
  for (const maps::Pose& pose : parked)
    fixed_.push_back(Fixed{.box = {pose, options_.car.length, options_.car.width}});
  // The memory of the last run is used again.
  if (cars_.size() > cars.size())
    cars_.erase(cars_.begin() + static_cast<std::ptrdiff_t>(cars.size()), cars_.end());
  while (cars_.size() < cars.size())
    cars_.emplace_back(Plant(options_.car, options_.plant, options_.time_step));
  boxes_.assign(cars.size(), Box{{}, options_.car.length, options_.car.width});
  for (std::size_t i = 0; i < cars.size(); ++i) {
    Car& car = cars_[i];
    CarState state{.x = cars[i].x, .y = cars[i].y, .yaw = cars[i].yaw};
    car.plant.reset(state);
    car.before = state;
    car.zone.reset({state.x, state.y}, cars[0].yaw);
    if (const LapPath* path = track_->lap_path()) {
      if (!car.timer) car.timer.emplace(*path, options_.sectors);
      car.timer->reset(*path, {state.x, state.y}, 0);
    }
    car.noise.reset(seed, i);
    car.gym_noise = NumpyRandom(12345);
    car.ranges.assign(lidar_.padded_beams(), static_cast<float>(options_.lidar.range_max));
    if (options_.lidar.gym.ranges) car.gym_ranges.assign(beams, options_.lidar.range_max);
    car.colliding.clear();
    car.wall = car.away = false;
    boxes_[i].pose = cars[i];
  }
  flags_.assign(bodies(), 0);
  partners_.assign(bodies(), -1);
  for (Car& car : cars_) car.colliding.reserve(bodies());
  find_fixed_partners();
  if (!options_.start_anywhere)
    for (std::size_t i = 0; i < cars_.size(); ++i) check_start(i);
  if (options_.gym.reset_step) {
    const std::vector<Command> zero(cars.size());
    step(zero);
  } else {
    find_collisions();
    scan_all();
  }
}

void World::check_start(std::size_t car) const {
  const auto fail = [&](const std::string& where) {
    const maps::Pose& p = boxes_[car].pose;
    throw std::invalid_argument("start of car " + std::to_string(car) + " at (" + std::to_string(p.x) + ", " +
                                std::to_string(p.y) + ", " + std::to_string(p.yaw) + "): lies in " + where);
  };
  if (track_->collides_with_wall(boxes_[car])) fail("a wall");
  for (std::size_t other = 0; other < cars_.size(); ++other)
    if (other != car && signed_gap(boxes_[car], boxes_[other]) <= 0) fail("car " + std::to_string(other));
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    if (collides(boxes_[car], fixed_[i])) fail("body " + std::to_string(cars_.size() + i));
}

int World::add(const Fixed& body) {
  require_finite("pose of a body", body.box.pose);
  detail::require_positive("length of a body", body.box.length);
  detail::require_positive("width of a body", body.box.width);
  fixed_.push_back(body);
  flags_.push_back(0);
  partners_.push_back(-1);
  for (Car& car : cars_) car.colliding.reserve(bodies());
  find_fixed_partners();
  return static_cast<int>(bodies()) - 1;
}

int World::add_parked_car(const maps::Pose& pose) {
  return add(Fixed{.box = {pose, options_.car.length, options_.car.width}});
}
int World::add_box(const Box& box) {
  return add(Fixed{.box = box});
}
int World::add_disc(const Disc& disc) {
  return add({{{disc.middle.x, disc.middle.y, 0}, 2 * disc.radius, 2 * disc.radius}, disc.radius});
}

void World::move_body(int body, const maps::Pose& pose) {
  require_finite("pose of a body", pose);
  if (body < static_cast<int>(cars_.size()) || body >= static_cast<int>(bodies()))
    throw std::invalid_argument("body = " + std::to_string(body) + ": must be a parked car, a box or a disc");
  fixed_[static_cast<std::size_t>(body) - cars_.size()].box.pose = pose;
  find_fixed_partners();
}

void World::remove_body(int body) {
  const auto driven = static_cast<int>(cars_.size());
  if (body < driven || body >= static_cast<int>(bodies()))
    throw std::invalid_argument("body = " + std::to_string(body) + ": must be a parked car, a box or a disc");
  fixed_.erase(fixed_.begin() + (body - driven));
  flags_.erase(flags_.begin() + body);
  partners_.erase(partners_.begin() + body);
  for (int& partner : partners_) partner = partner == body ? -1 : partner > body ? partner - 1 : partner;
  for (Car& car : cars_) {
    std::erase(car.colliding, body);
    for (int& other : car.colliding) other -= other > body;
  }
  find_fixed_partners();
}

void World::set_state(std::size_t car, const CarState& state) {
  require_finite(state);
  cars_.at(car).plant.set_state(state);
  cars_[car].before = state;
  boxes_[car].pose = pose_of(state);
  if (cars_[car].timer) cars_[car].timer->relocate(*track_->lap_path(), {state.x, state.y});
}

void World::take_away(std::size_t car) {
  Car& taken = cars_.at(car);
  taken.away = true;
  CarState state = taken.plant.state();
  state.speed = state.yaw_rate = state.slip = 0;
  taken.plant.set_state(state);
  taken.before = state;
  taken.wall = false;
  taken.colliding.clear();
  for (Car& other : cars_) std::erase(other.colliding, static_cast<int>(car));
  flags_[car] = 0;
  partners_[car] = -1;
}

void World::set_scanning(std::size_t car, bool scans) {
  cars_.at(car).scans = scans;
}

Observation World::observe(std::size_t index) const noexcept {
  const Car& car = cars_[index];
  const CarState& s = car.plant.state();
  return {.pose = pose_of(s),
          .sensor = car.sensor,
          .speed = s.speed,
          .steer = s.steer,
          .yaw_rate = s.yaw_rate,
          .slip = s.slip,
          .time = time_,
          .scan_time = car.scan_time,
          .scan = {.ranges = std::span(car.ranges).first(static_cast<std::size_t>(options_.lidar.beams)),
                   .angle_min = options_.lidar.angle_min(),
                   .angle_increment = options_.lidar.angle_increment(),
                   .range_min = 0,
                   .range_max = options_.lidar.range_max},
          .gym_ranges = car.gym_ranges,
          .wall = car.wall,
          .colliding = car.colliding};
}

Box World::outline(std::size_t body) const noexcept {
  if (body >= cars_.size()) return fixed_[body - cars_.size()].box;
  return {pose_of(cars_[body].plant.state()), options_.car.length, options_.car.width};
}

std::optional<Disc> World::disc(std::size_t body) const noexcept {
  if (body < cars_.size() || fixed_[body - cars_.size()].disc_radius <= 0) return {};
  const Fixed& fixed = fixed_[body - cars_.size()];
  return Disc{{fixed.box.pose.x, fixed.box.pose.y}, fixed.disc_radius};
}

StepStatus World::step(std::span<const Command> commands) noexcept {
  StepStatus status = commands.size() < cars_.size() ? StepStatus::missing_command : StepStatus::ok;
  for (std::size_t i = 0; i < cars_.size(); ++i) {
    Car& car = cars_[i];
    if (car.away) continue;
    car.before = car.plant.state();
    if (i >= commands.size()) {
      car.plant.coast();
    } else {
      if (!std::isfinite(commands[i].steer) || !std::isfinite(commands[i].speed))
        status = StepStatus::non_finite_command;
      car.plant.step(commands[i]);
    }
    boxes_[i].pose = pose_of(car.plant.state());
  }
  ++steps_;
  // The time is a sum, as in f1tenth_gym, whose lap times are sums.
  time_ += options_.time_step;
  if (options_.gym.wall_collision)
    gym_scan_and_collisions();
  else {
    find_collisions();
    if (options_.body_response == CollisionResponse::slide_unless_struck)
      for (std::size_t i = 0; i < cars_.size(); ++i) cars_[i].struck = was_struck(i);
    for (std::size_t i = 0; i < cars_.size(); ++i)
      if (cars_[i].wall || !cars_[i].colliding.empty()) respond(i);
    if (scan_is_due()) scan_all();
  }
  count_laps();
  return status;
}

void World::count_laps() noexcept {
  for (Car& car : cars_) {
    if (car.away) continue;
    const maps::Point at{car.plant.state().x, car.plant.state().y};
    car.zone.update(at, time_);
    if (car.timer) car.timer->update(*track_->lap_path(), at, time_);
  }
}

void World::follow(std::span<const CarState> states) {
  if (states.size() != cars_.size())
    throw std::invalid_argument("states: " + std::to_string(states.size()) + " must be as many as cars, " +
                                std::to_string(cars_.size()));
  for (const CarState& state : states) require_finite(state);
  for (std::size_t i = 0; i < cars_.size(); ++i) {
    cars_[i].before = states[i];
    cars_[i].plant.set_state(states[i]);
    boxes_[i].pose = pose_of(states[i]);
  }
  ++steps_;
  time_ += options_.time_step;
  find_collisions();
  if (scan_is_due()) scan_all();
  count_laps();
}

bool World::scan_is_due() const noexcept {
  return steps_ % scan_every_ == 0;
}

}  // namespace slalom::sim
