#include <algorithm>

#include "slalom/sim/world.hpp"

namespace slalom::sim {
namespace {

double reach(const Box& box) {
  return std::sqrt(box.length * box.length + box.width * box.width) / 2;
}

bool far_apart(const Box& a, const Box& b) {
  const double dx = a.pose.x - b.pose.x, dy = a.pose.y - b.pose.y, sum = reach(a) + reach(b);
  return dx * dx + dy * dy > sum * sum;
}

}  // namespace

bool World::collides(const Box& car, const Fixed& body) const noexcept {
  if (far_apart(car, body.box)) return false;
  return (body.disc_radius > 0 ? signed_gap(car, body.disc()) : signed_gap(car, body.box)) <= 0;
}

void World::find_fixed_partners() noexcept {
  const auto touch = [&](const Fixed& a, const Fixed& b) {
    if (!(a.disc_radius > 0)) return collides(a.box, b);
    if (!(b.disc_radius > 0)) return collides(b.box, a);
    return signed_gap(a.box, b.box) <= 0;  // the squares around two discs, which is sufficient here
  };
  for (Fixed& body : fixed_) body.last_partner = -1;
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    for (std::size_t j = i + 1; j < fixed_.size(); ++j) {
      if (!touch(fixed_[i], fixed_[j])) continue;
      fixed_[i].last_partner = static_cast<int>(cars_.size() + j);  // partners are found in rising order
      fixed_[j].last_partner = static_cast<int>(cars_.size() + i);
    }
}

void World::find_collisions() noexcept {
  std::fill(partners_.begin(), partners_.end(), -1);
  for (DrivenCar& car : cars_) car.colliding.clear();
  const std::size_t driven = cars_.size();
  for (std::size_t i = 0; i < fixed_.size(); ++i) partners_[driven + i] = fixed_[i].last_partner;
  for (std::size_t i = 0; i < driven; ++i) {
    if (cars_[i].away) continue;
    for (std::size_t j = i + 1; j < driven; ++j)
      if (!cars_[j].away && !far_apart(boxes_[i], boxes_[j]) && signed_gap(boxes_[i], boxes_[j]) <= 0) {
        cars_[i].colliding.push_back(static_cast<int>(j));
        cars_[j].colliding.push_back(static_cast<int>(i));
      }
    for (std::size_t j = 0; j < fixed_.size(); ++j)
      if (collides(boxes_[i], fixed_[j])) {
        cars_[i].colliding.push_back(static_cast<int>(driven + j));
        int& partner = partners_[driven + j];
        partner = std::max(partner, static_cast<int>(i));
      }
  }
  for (std::size_t i = 0; i < driven; ++i) {
    if (!cars_[i].colliding.empty()) partners_[i] = cars_[i].colliding.back();
    if (cars_[i].away)
      cars_[i].wall = false;
    else if (!options_.gym)
      cars_[i].wall = track_->collides_with_wall(boxes_[i]);
  }
  for (std::size_t i = 0; i < bodies(); ++i) flags_[i] = partners_[i] >= 0 || (i < driven && cars_[i].wall);
}

void World::respond(std::size_t index) noexcept {
  DrivenCar& car = cars_[index];
  const bool at_bodies = !car.colliding.empty() && options_.body_response != CollisionResponse::count_only;
  const bool zeroes = car.wall && options_.gym;
  const bool at_wall = zeroes || (car.wall && options_.wall_response != CollisionResponse::count_only);
  if ((!at_bodies && !at_wall) || car.struck) return;
  const CarState tried = car.plant.state();
  const CollisionResponse response = at_wall ? options_.wall_response : options_.body_response;
  CarState state = zeroes ? tried : car.before;
  state.steer = tried.steer;
  state.speed = state.yaw_rate = state.slip = 0;
  if (zeroes) state.yaw = 0;
  if (!zeroes && response != CollisionResponse::stop) slide(index, tried, state);
  car.plant.set_state(state);
  boxes_[index].pose = state.pose();
}

/// Whether other cars drove into this car: it touches only driven cars, and their motion alone makes the
/// contact. Each of them would have touched it before it moved, and it would not have touched any of them
/// before they moved. Call it before any car responds.
bool World::was_struck(std::size_t index) const noexcept {
  const auto before = [&](std::size_t car) {
    return Box{cars_[car].before.pose(), boxes_[car].length, boxes_[car].width};
  };
  const std::vector<int>& touched = cars_[index].colliding;
  return !cars_[index].wall && std::all_of(touched.begin(), touched.end(), [&](int body) {
    const auto other = static_cast<std::size_t>(body);
    return other < cars_.size() && signed_gap(boxes_[index], before(other)) > 0 &&
           signed_gap(before(index), boxes_[other]) <= 0;
  });
}

bool World::is_free(std::size_t car, const maps::Pose& pose) const noexcept {
  const Box box{pose, options_.car.length, options_.car.width};
  if (options_.wall_response != CollisionResponse::count_only && track_->collides_with_wall(box))
    return false;
  if (options_.body_response == CollisionResponse::count_only) return true;
  for (std::size_t i = 0; i < cars_.size(); ++i)
    if (i != car && !cars_[i].away && !far_apart(box, boxes_[i]) && signed_gap(box, boxes_[i]) <= 0)
      return false;
  return std::none_of(fixed_.begin(), fixed_.end(), [&](const Fixed& body) { return collides(box, body); });
}

/// Keeps the part of the car's motion that leads along the obstacle: tries directions, beginning with the
/// least turn from the motion, until the car is free there. This needs no normal of the obstacle.
void World::slide(std::size_t car, const CarState& tried, CarState& state) const noexcept {
  const double dx = tried.x - state.x, dy = tried.y - state.y;
  for (const double yaw : {tried.yaw, state.yaw})
    for (int degrees = 0; degrees <= 80; degrees += 10)
      for (const int side : {1, -1}) {
        const double turn = side * degrees * (3.141592653589793 / 180);
        const double c = std::cos(turn), s = std::sin(turn);
        const maps::Pose pose{state.x + c * (c * dx - s * dy), state.y + c * (s * dx + c * dy), yaw};
        if (!is_free(car, pose)) continue;
        state.x = pose.x;
        state.y = pose.y;
        state.yaw = yaw;
        state.speed = c * tried.speed;
        return;
      }
}

void CollisionLog::update(const World& world, std::size_t car) {
  const Observation seen = world.observe(car);
  if (!seen.collides()) return;
  wall_ = wall_ || seen.wall;
  for (const int body : seen.colliding) {
    const auto at = std::lower_bound(bodies_.begin(), bodies_.end(), body);
    if (at == bodies_.end() || *at != body) bodies_.insert(at, body);
  }
  const auto flags = world.flags().subspan(world.cars());
  const auto same = [&](const std::vector<std::uint8_t>& pattern) {
    return std::equal(pattern.begin(), pattern.end(), flags.begin(), flags.end());
  };
  if (std::none_of(patterns_.begin(), patterns_.end(), same))
    patterns_.emplace_back(flags.begin(), flags.end());
}

}  // namespace slalom::sim
