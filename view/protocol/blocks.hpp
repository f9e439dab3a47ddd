#pragma once

#include "slalom/view/subject.hpp"
#include "view/protocol/frame_writer.hpp"

/// The blocks of a message that describe the scene.
namespace slalom::view {

/// Writes a block of lines, if there are any.
void put_lines(FrameWriter& to, Block block, const std::vector<Line>& lines);

/// Writes the body, 0, and the shapes, whose numbers are their indices + 1; polygons apart.
void put_bodies(FrameWriter& to, const Shape& body, const std::vector<Shape>& shapes);

}  // namespace slalom::view
