#include "view/session/simulation.hpp"

#include <stdexcept>
#include <utility>

namespace slalom::view {
namespace {

void add(sim::World& world, const AddBody& body) {
  if (world.bodies() >= 512) throw std::invalid_argument("bodies: at most 512 are supported");
  if (body.kind == BodyKind::parked_car)
    world.add_parked_car(body.pose);
  else if (body.kind == BodyKind::disc)
    world.add_disc({{body.pose.x, body.pose.y}, 0.5 * body.length});
  else
    world.add_box({body.pose, body.length, body.width});
}

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

Simulation::Simulation(const evaluation::LapSetup& setup, std::uint64_t seed)
    : first_setup_(setup), seed_(seed), loop_(setup, seed) {}

void Simulation::tick(const evaluation::ControlStepCallback& on_step, bool real_time) {
  const double delay = real_time ? last_update_ : 0;
  if (delay > 0) {
    delays_.resize(static_cast<std::size_t>(ticks()) + 1, 0.0f);
    delays_.back() = static_cast<float>(delay);
  }
  // The delay is rounded to float for the log, and the loop shall be that of the log.
  loop_.step(
      [&](const evaluation::ControlStep& step) {
        last_update_ = step.output.tick_time;
        if (on_step) on_step(step);
      },
      static_cast<float>(delay));
}

void Simulation::apply(const Edit& edit) {
  perform(edit);
  log_.push_back({ticks(), edit});
}

void Simulation::follow(const Simulation& source) {
  const auto at = static_cast<std::size_t>(ticks());
  // The log of this simulation is the beginning of that of the source.
  while (log_.size() < source.log_.size() && source.log_[log_.size()].tick <= ticks())
    apply(source.log_[log_.size()].edit);
  const float delay = at < source.delays_.size() ? source.delays_[at] : 0.0f;
  if (at < source.delays_.size()) {
    delays_.resize(at + 1, 0.0f);
    delays_.back() = delay;
  }
  loop_.step({}, delay);
}

void Simulation::go_back(Simulation&& earlier) {
  const double last_update = last_update_;  // of this computer's clock, which does not go back
  *this = std::move(earlier);
  last_update_ = last_update;
}

void Simulation::perform(const Edit& edit) {
  sim::World& world = loop_.world();
  struct Perform {
    evaluation::LapDrive& loop;
    sim::World& world;
    void operator()(const AddBody& e) const { add(world, e); }
    void operator()(const MoveBody& e) const { world.move_body(e.body, e.pose); }
    void operator()(const RemoveBody& e) const { world.remove_body(e.body); }
    void operator()(const SetBodies& e) const {
      while (world.bodies() > world.cars()) world.remove_body(static_cast<int>(world.bodies()) - 1);
      for (const AddBody& body : e.bodies) add(world, body);
    }
    void operator()(const MoveCar& e) const {
      sim::CarState state = world.state(0);
      if (world.track().in_wall({e.pose.x, e.pose.y}))
        throw std::invalid_argument("car: must not overlap a wall");
      state.x = e.pose.x;
      state.y = e.pose.y;
      state.yaw = e.pose.yaw;
      world.set_state(0, state);
    }
    void operator()(const ChangeDriver& e) const { loop.change_driver(e.driver); }
  };
  std::visit(Perform{loop_, world}, edit);
}

}  // namespace slalom::view
