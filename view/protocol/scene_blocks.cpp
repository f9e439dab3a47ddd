#include "view/protocol/blocks.hpp"

#include "view/protocol/frame.hpp"

namespace slalom::view {
namespace {

/// The number of a shape's kind in the block `bodies`.
int kind_of(const Shape& shape) {
  switch (shape.kind) {
    case ShapeKind::parked_car:
      return 1;
    case ShapeKind::opponent:
      return 4;
    case ShapeKind::mover:
      return 5;
    case ShapeKind::goal:
      return 6;
    case ShapeKind::obstacle:
      break;
  }
  return shape.is_disc ? 3 : 2;
}

void put_body(FrameWriter& to, std::size_t id, int kind, const Shape& shape) {
  to.put(static_cast<std::uint16_t>(id));
  to.put(static_cast<std::uint8_t>(kind));
  to.put(static_cast<std::uint8_t>(shape.touched));
  to.put_f32({shape.pose.x, shape.pose.y, shape.pose.yaw, shape.length, shape.width});
}

}  // namespace

void put_lines(FrameWriter& to, Block block, const std::vector<Line>& lines) {
  if (lines.empty()) return;
  to.begin(block);
  to.put(static_cast<std::uint32_t>(lines.size()));
  for (const Line& line : lines) {
    to.put(static_cast<std::uint32_t>(line.size()));
    for (const maps::Point& p : line) to.put_f32({p.x, p.y});
  }
  to.end();
}

void put_bodies(FrameWriter& to, const Shape& body, const std::vector<Shape>& shapes) {
  std::vector<Line> polygons;
  to.begin(Block::bodies);
  const auto count =
      std::count_if(shapes.begin(), shapes.end(), [](const Shape& s) { return s.corners.empty(); });
  to.put(static_cast<std::uint32_t>(1 + count));
  put_body(to, 0, 0, body);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (shapes[i].corners.empty())
      put_body(to, i + 1, kind_of(shapes[i]), shapes[i]);
    else
      polygons.push_back(shapes[i].corners);
  }
  to.end();
  put_lines(to, Block::polygons, polygons);
}

std::string encode_ghost_frame(std::string_view frame) {
  FrameWriter to;
  to.begin(Block::ghost_frame);
  to.append(frame);
  to.end();
  return to.take_blocks();
}

std::string encode_scene(const SubjectFacts& facts) {
  if (!facts.map && facts.course.empty()) return {};
  FrameWriter to;
  if (facts.map) to.put_grid(*facts.map);
  if (!facts.course.empty()) {
    to.begin(Block::path);
    to.put(static_cast<std::uint32_t>(facts.course.size()));
    to.put(static_cast<std::uint32_t>(facts.is_closed));
    for (const maps::ReferencePoint& p : facts.course) to.put_f32({p.x, p.y, p.speed});
    to.end();
  }
  return to.take();
}

}  // namespace slalom::view
