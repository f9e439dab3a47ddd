#include "slalom/sim/world.hpp"

#include <algorithm>

#include "slalom/maps/pose_limits.hpp"

namespace slalom::sim {
namespace {

void require_plausible(const CarState& state) {
  maps::check_pose("state", state.pose());
  if (!state.is_finite())
    throw std::invalid_argument("state: steer, speed, yaw_rate and slip must be finite");
}

}  // namespace

WorldOptions WorldOptions::gym_compatible() {
  return {.plant = {.dynamics = {.substeps = 1, .gym = true}, .actuation = {.gym = true}, .gym = true},
          .lidar = {.mount = {}, .gym = true},
          .body_response = CollisionResponse::count_only,
          .gym = true};
}

void WorldOptions::validate() const {
  validate_options(*this, "world");
  // Their constructors check what depends on several options.
  [[maybe_unused]] const Plant plant_of_a_car(car, plant, time_step);
  [[maybe_unused]] const Lidar scanner(lidar);
  if (gym != lidar.gym) throw std::invalid_argument("world.gym: must be that of the LiDAR");
  if (gym && lidar.rate > 0 && std::lround(1 / (lidar.rate * time_step)) > 1)
    throw std::invalid_argument("world.gym: needs a scan in every step, so scan_rate must be 0");
}

World::World(const WorldOptions& options, std::shared_ptr<const Track> track)
    : options_((options.validate(), options)),
      track_(std::move(track)),
      lidar_(options.lidar),
      time_to_collision_(options.lidar, options.car) {
  if (!track_) throw std::invalid_argument("track: must not be null");
  if (options.lidar.rate > 0)
    scan_every_ = std::max<std::int64_t>(1, std::lround(1 / (options.lidar.rate * options.time_step)));
}

void World::reset(std::uint64_t seed, std::span<const maps::Pose> cars, std::span<const maps::Pose> parked) {
  for (const maps::Pose& pose : cars) maps::check_pose("start of a driven car", pose);
  for (const maps::Pose& pose : parked) maps::check_pose("pose of a parked car", pose);
  time_ = 0;
  steps_ = 0;
  const Box body{{}, options_.car.length, options_.car.width};
  fixed_.assign(parked.size(), Fixed{.box = body});
  for (std::size_t i = 0; i < parked.size(); ++i) fixed_[i].box.pose = parked[i];
  boxes_.assign(cars.size(), body);
  cars_.resize(cars.size(), DrivenCar(Plant(options_.car, options_.plant, options_.time_step)));
  for (std::size_t i = 0; i < cars.size(); ++i) {
    place(i, cars[i], cars[0].yaw);
    cars_[i].noise.reset(seed, i);
  }
  flags_.assign(bodies(), 0);
  partners_.assign(bodies(), -1);
  find_fixed_partners();
  if (options_.gym) {
    step(std::vector<Command>(cars.size()));
    return;
  }
  for (std::size_t i = 0; i < cars_.size(); ++i) check_start(i);
  find_collisions();
  scan_if_due();
}

/// Puts a driven car at its start, where its laps begin; `heading` (rad) is the yaw of the first car.
void World::place(std::size_t index, const maps::Pose& start, double heading) {
  DrivenCar& car = cars_[index];
  car.before = {.x = start.x, .y = start.y, .yaw = start.yaw};
  car.plant.reset(car.before);
  car.zone.reset({start.x, start.y}, heading);
  if (const LapPath* path = track_->lap_path()) {
    if (!car.timer) car.timer.emplace(*path);
    car.timer->reset(*path, start, 0);
  }
  car.gym_noise = NumpyRandom(12345);
  car.ranges.assign(lidar_.padded_beams(), static_cast<float>(options_.lidar.range_max));
  if (options_.gym) car.gym_ranges.assign(lidar_.angles().size(), options_.lidar.range_max);
  car.colliding.clear();
  car.colliding.reserve(bodies());
  car.wall = car.away = false;
  boxes_[index].pose = start;
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
  maps::check_pose("pose of a body", body.box.pose);
  slalom::detail::check("body", {"length", "m", "", 1e-9, 1e9}, body.box.length);
  slalom::detail::check("body", {"width", "m", "", 1e-9, 1e9}, body.box.width);
  fixed_.push_back(body);
  flags_.push_back(0);
  partners_.push_back(-1);
  for (DrivenCar& car : cars_) car.colliding.reserve(bodies());
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

World::Fixed& World::fixed(int body) {
  const auto driven = static_cast<int>(cars_.size());
  if (body < driven || body >= static_cast<int>(bodies()))
    throw std::invalid_argument("body = " + std::to_string(body) + ": must be a parked car, a box or a disc");
  return fixed_[body - driven];
}

void World::move_body(int body, const maps::Pose& pose) {
  maps::check_pose("pose of a body", pose);
  fixed(body).box.pose = pose;
  find_fixed_partners();
}

void World::remove_body(int body) {
  fixed_.erase(fixed_.begin() + (&fixed(body) - fixed_.data()));
  flags_.erase(flags_.begin() + body);
  partners_.erase(partners_.begin() + body);
  for (int& partner : partners_) partner = partner == body ? -1 : partner > body ? partner - 1 : partner;
  for (DrivenCar& car : cars_) {
    std::erase(car.colliding, body);
    for (int& other : car.colliding) other -= other > body;
  }
  find_fixed_partners();
}

void World::set_state(std::size_t car, const CarState& state) {
  require_plausible(state);
  cars_.at(car).plant.set_state(state);
  cars_[car].before = state;
  boxes_[car].pose = state.pose();
  if (cars_[car].timer) cars_[car].timer->relocate(*track_->lap_path(), {state.x, state.y, state.yaw});
}

void World::take_away(std::size_t car) {
  DrivenCar& taken = cars_.at(car);
  taken.away = true;
  CarState state = taken.plant.state();
  state.speed = state.yaw_rate = state.slip = 0;
  taken.plant.set_state(state);
  taken.before = state;
  taken.wall = false;
  taken.colliding.clear();
  for (DrivenCar& other : cars_) std::erase(other.colliding, static_cast<int>(car));
  flags_[car] = 0;
  partners_[car] = -1;
}

void World::set_scanning(std::size_t car, bool scans) {
  cars_.at(car).scans = scans;
}

Observation World::observe(std::size_t index) const noexcept {
  const DrivenCar& car = cars_[index];
  const CarState& s = car.plant.state();
  return {.pose = s.pose(),
          .sensor = car.sensor,
          .speed = s.speed,
          .steer = s.steer,
          .yaw_rate = s.yaw_rate,
          .slip = s.slip,
          .time = time_,
          .scan_time = car.scan_time,
          .scan = {.ranges = std::span(car.ranges).first(options_.lidar.beams),
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
  return {cars_[body].plant.state().pose(), options_.car.length, options_.car.width};
}

std::optional<Disc> World::disc(std::size_t body) const noexcept {
  if (body < cars_.size() || fixed_[body - cars_.size()].disc_radius <= 0) return {};
  return fixed_[body - cars_.size()].disc();
}

StepStatus World::step(std::span<const Command> commands) noexcept {
  StepStatus status = commands.size() < cars_.size() ? StepStatus::missing_command : StepStatus::ok;
  for (std::size_t i = 0; i < cars_.size(); ++i) {
    DrivenCar& car = cars_[i];
    if (car.away) continue;
    car.before = car.plant.state();
    if (i >= commands.size()) {
      car.plant.coast();
    } else {
      if (!std::isfinite(commands[i].steer) || !std::isfinite(commands[i].speed))
        status = StepStatus::non_finite_command;
      car.plant.step(commands[i]);
    }
    boxes_[i].pose = car.plant.state().pose();
  }
  ++steps_;
  // The time is a sum, as in f1tenth_gym, whose lap times are sums.
  time_ += options_.time_step;
  if (options_.gym) {
    gym_scan_and_collisions();
  } else {
    find_collisions();
    if (options_.body_response == CollisionResponse::slide_unless_struck)
      for (std::size_t i = 0; i < cars_.size(); ++i) cars_[i].struck = was_struck(i);
    for (std::size_t i = 0; i < cars_.size(); ++i)
      if (cars_[i].wall || !cars_[i].colliding.empty()) respond(i);
    scan_if_due();
  }
  count_laps();
  return status;
}

void World::count_laps() noexcept {
  for (DrivenCar& car : cars_) {
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
  for (const CarState& state : states) require_plausible(state);
  for (std::size_t i = 0; i < cars_.size(); ++i) {
    cars_[i].before = states[i];
    cars_[i].plant.set_state(states[i]);
    boxes_[i].pose = states[i].pose();
  }
  ++steps_;
  time_ += options_.time_step;
  find_collisions();
  scan_if_due();
  count_laps();
}

}  // namespace slalom::sim
