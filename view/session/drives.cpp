#include "view/session/drives.hpp"

#include <stdexcept>
#include <utility>

namespace slalom::view {
namespace {

constexpr std::size_t max_bodies = 512;

/// An action that changes the worlds of car and ghost in the same way.
template <class Edit>
Action edit_worlds(Edit edit) {
  return [edit = std::move(edit)](Drives& drives) {
    drives.edited = true;
    edit(drives.car.world());
    if (drives.ghost) edit(drives.ghost->world());
  };
}

void require_room(const sim::World& world) {
  if (world.bodies() >= max_bodies) throw std::invalid_argument("bodies: at most 512 are supported");
}

void add(sim::World& world, const Body& body) {
  require_room(world);
  if (body.is_disc)
    world.add_disc({{body.pose.x, body.pose.y}, 0.5 * body.length});
  else
    world.add_box({body.pose, body.length, body.width});
}

}  // namespace

void Drives::tick(const Delays& delays, const evaluation::ControlStepCallback& on_car,
                  const evaluation::ControlStepCallback& on_ghost) {
  if (ghost) ghost->step(on_ghost, delays.ghost);
  car.step(on_car, delays.car);
}

std::vector<Body> bodies_of(const sim::World& world) {
  std::vector<Body> bodies;
  for (std::size_t i = world.cars(); i < world.bodies(); ++i) {
    const sim::Box box = world.outline(i);
    bodies.push_back({box.pose, box.length, box.width, world.disc(i).has_value()});
  }
  return bodies;
}

Action add_body(const Body& body) {
  return edit_worlds([body](sim::World& world) { add(world, body); });
}

Action add_parked_car(const maps::Pose& pose) {
  return edit_worlds([pose](sim::World& world) {
    require_room(world);
    world.add_parked_car(pose);
  });
}

Action move_body(int body, const maps::Pose& pose) {
  return edit_worlds([body, pose](sim::World& world) { world.move_body(body, pose); });
}

Action remove_body(int body) {
  return edit_worlds([body](sim::World& world) { world.remove_body(body); });
}

Action set_bodies(std::vector<Body> bodies) {
  return edit_worlds([bodies = std::move(bodies)](sim::World& world) {
    while (world.bodies() > world.cars()) world.remove_body(static_cast<int>(world.bodies()) - 1);
    for (const Body& body : bodies) add(world, body);
  });
}

Action move_car(const maps::Pose& pose) {
  return [pose](Drives& drives) {
    sim::World& world = drives.car.world();
    if (world.track().in_wall({pose.x, pose.y})) throw std::invalid_argument("car: must not overlap a wall");
    sim::CarState state = world.state(0);
    state.x = pose.x;
    state.y = pose.y;
    state.yaw = pose.yaw;
    world.set_state(0, state);
    drives.edited = true;
  };
}

Action change_driver(evaluation::Driver driver) {
  return [driver = std::move(driver)](Drives& drives) {
    drives.car.change_driver(driver);
    drives.edited = true;
  };
}

Action start_ghost(std::string label, std::optional<evaluation::Driver> driver) {
  return [label = std::move(label), driver = std::move(driver)](Drives& drives) {
    drives.ghost = drives.car;
    if (driver) drives.ghost->change_driver(*driver);
    drives.ghost_label = label;
  };
}

void end_ghost(Drives& drives) {
  drives.ghost.reset();
  drives.ghost_label.clear();
}

}  // namespace slalom::view
