#include "view/session/drives.hpp"

#include <stdexcept>
#include <utility>

namespace slalom::view {
namespace {

constexpr std::size_t max_bodies = 512;

void add(sim::World& world, const AddBody& body) {
  if (world.bodies() >= max_bodies) throw std::invalid_argument("bodies: at most 512 are supported");
  if (body.kind == BodyKind::parked_car)
    world.add_parked_car(body.pose);
  else if (body.kind == BodyKind::disc)
    world.add_disc({{body.pose.x, body.pose.y}, 0.5 * body.length});
  else
    world.add_box({body.pose, body.length, body.width});
}

/// Applies the edits of bodies, which concern the worlds of car and ghost.
struct EditBodies {
  sim::World& world;
  void operator()(const AddBody& e) const { add(world, e); }
  void operator()(const MoveBody& e) const { world.move_body(e.body, e.pose); }
  void operator()(const RemoveBody& e) const { world.remove_body(e.body); }
  void operator()(const SetBodies& e) const {
    while (world.bodies() > world.cars()) world.remove_body(static_cast<int>(world.bodies()) - 1);
    for (const AddBody& body : e.bodies) add(world, body);
  }
  template <class Other>
  void operator()(const Other&) const {}
};

/// Applies the other actions.
struct ChangeDrives {
  Drives& drives;
  void operator()(const MoveCar& e) const {
    sim::World& world = drives.car.world();
    if (world.track().in_wall({e.pose.x, e.pose.y}))
      throw std::invalid_argument("car: must not overlap a wall");
    sim::CarState state = world.state(0);
    state.x = e.pose.x;
    state.y = e.pose.y;
    state.yaw = e.pose.yaw;
    world.set_state(0, state);
  }
  void operator()(const ChangeDriver& e) const { drives.car.change_driver(e.driver); }
  void operator()(const StartGhost& e) const {
    evaluation::LapDrive ghost = drives.car;
    if (e.driver) ghost.change_driver(*e.driver);
    drives.ghost = std::move(ghost);
    drives.ghost_label = e.label;
  }
  void operator()(const EndGhost&) const {
    drives.ghost.reset();
    drives.ghost_label.clear();
  }
  template <class Other>
  void operator()(const Other&) const {}
};

}  // namespace

std::vector<AddBody> bodies_of(const sim::World& world) {
  std::vector<AddBody> bodies;
  for (std::size_t i = world.cars(); i < world.bodies(); ++i) {
    const sim::Box box = world.outline(i);
    bodies.push_back({.kind = world.disc(i) ? BodyKind::disc : BodyKind::box,
                      .pose = box.pose,
                      .length = box.length,
                      .width = box.width});
  }
  return bodies;
}

void Drives::tick(const Delays& delays, const evaluation::ControlStepCallback& on_car,
                  const evaluation::ControlStepCallback& on_ghost) {
  if (ghost) ghost->step(on_ghost, delays.ghost);
  car.step(on_car, delays.car);
}

void Drives::apply(const Action& action) {
  std::visit(EditBodies{car.world()}, action);
  if (ghost) std::visit(EditBodies{ghost->world()}, action);
  std::visit(ChangeDrives{*this}, action);
  if (!std::holds_alternative<StartGhost>(action) && !std::holds_alternative<EndGhost>(action)) edited = true;
}

}  // namespace slalom::view
