#include "view/protocol/frame_writer.hpp"

#include <iterator>
#include <sstream>

namespace slalom::view {

std::vector<std::string> words_of(const char* text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}

void FrameWriter::begin(Block block) {
  put(static_cast<std::uint16_t>(block));
  put(std::uint16_t{0});
  length_at_ = bytes_.size();
  put(std::uint32_t{0});
}

void FrameWriter::end() {
  const auto length = static_cast<std::uint32_t>(bytes_.size() - length_at_ - 4);
  std::memcpy(bytes_.data() + length_at_, &length, sizeof length);
  pad();
}

void FrameWriter::put_grid(const maps::OccupancyGrid& grid) {
  std::vector<std::uint32_t> runs;
  for (const maps::Occupancy cell : grid.cells) {
    const auto value = static_cast<std::uint32_t>(cell);
    if (runs.empty() || runs.back() >> 24 != value || (runs.back() & 0xffffffu) == 0xffffffu)
      runs.push_back(value << 24);
    ++runs.back();
  }
  begin(Block::grid);
  put(static_cast<std::uint32_t>(grid.width));
  put(static_cast<std::uint32_t>(grid.height));
  put(grid.resolution);
  put_pose(grid.origin);
  put(static_cast<std::uint32_t>(runs.size()));
  for (const std::uint32_t run : runs) put(run);
  end();
}

void FrameWriter::begin_points(const maps::Point& origin, double unit) {
  origin_ = origin;
  unit_ = unit;
  last_x_ = last_y_ = 0;
  put(origin.x);
  put(origin.y);
  put_f32(unit);
}

void FrameWriter::put_point(const maps::Point& point) {
  put_difference(counts(point.x - origin_.x), last_x_);
  put_difference(counts(point.y - origin_.y), last_y_);
}

std::int16_t FrameWriter::counts(double metres) const {
  const double value = std::round(metres / unit_);
  return static_cast<std::int16_t>(value > 32767 ? 32767 : value > -32767 ? value : -32767);
}

/// Stores a difference modulo 2^16, so that it always fits.
void FrameWriter::put_difference(std::int16_t now, std::int16_t& last) {
  put(static_cast<std::int16_t>(now - last));
  last = now;
}

}  // namespace slalom::view
