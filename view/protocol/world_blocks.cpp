// The blocks of a message that describe the world: its bodies, the ghost, the course.
#include <algorithm>
#include <limits>

#include "slalom/sim/shapes.hpp"
#include "view/protocol/frame.hpp"
#include "view/protocol/frame_writer.hpp"

namespace slalom::view {

double clearance_of(const sim::World& world) {
  const sim::Box body = world.outline(0);
  double least = std::numeric_limits<double>::infinity();
  for (const maps::Point& corner : sim::corners(body))
    least = std::min(least, world.track().distance_to_wall(corner));
  for (std::size_t i = 1; i < world.bodies(); ++i) {
    const auto disc = world.disc(i);
    least = std::min(least, disc ? sim::signed_gap(body, *disc) : sim::signed_gap(body, world.outline(i)));
  }
  return least;
}

std::string encode_bodies(const sim::World& world) {
  FrameWriter to;
  to.begin(Block::bodies);
  to.put(static_cast<std::uint32_t>(world.bodies()));
  const sim::Observation seen = world.observe(0);
  for (std::size_t i = 0; i < world.bodies(); ++i) {
    const sim::Box box = world.outline(i);
    const bool is_car = box.length == world.options().car.length && box.width == world.options().car.width;
    const int kind = i == 0 ? 0 : i < world.cars() ? 4 : world.disc(i) ? 3 : is_car ? 1 : 2;
    const bool hit = i == 0 ? seen.collides()
                            : std::find(seen.colliding.begin(), seen.colliding.end(), static_cast<int>(i)) !=
                                  seen.colliding.end();
    to.put_body(i, kind, hit, box.pose, box.length, box.width);
  }
  to.end();
  return to.take_blocks();
}

std::string encode_ghost_frame(std::string_view frame) {
  FrameWriter to;
  to.begin(Block::ghost_frame);
  to.append(frame);
  to.end();
  return to.take_blocks();
}

std::string encode_scene(const evaluation::Environment& environment) {
  FrameWriter to;
  to.put_grid(environment.course.map);
  to.begin(Block::path);
  to.put(static_cast<std::uint32_t>(environment.path.size()));
  to.put(static_cast<std::uint32_t>(environment.course.closed));
  for (const maps::ReferencePoint& p : environment.path) to.put_f32({p.x, p.y, p.speed});
  to.end();
  return to.take();
}

}  // namespace slalom::view
