#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "slalom/maps/occupancy_grid.hpp"

namespace slalom::view {

/// The blocks of a binary message, which docs/live-view.md describes.
enum class Block : std::uint16_t {
  scalars = 1,
  scan = 2,
  cost_map = 3,
  candidates = 4,
  guides = 5,
  nominal = 6,
  plan = 7,
  bodies = 8,
  covariance = 9,
  ghost = 10,
  ghost_frame = 11,
  others = 12,
  figure = 13,
  polygons = 14,
  step_costs = 16,
  inputs = 17,
  effective_samples = 18,
  lines = 19,
  grid = 20,
  path = 21,
  past = 22,
  file = 30,
};

/// The words of a text.
inline std::vector<std::string> words_of(const char* text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}

/// Writes a binary message: "SLV1", then blocks of kind (u16), 0 (u16), length (u32) and payload, padded with
/// zeros to four bytes. Numbers are little-endian, as in the memory of all supported machines.
class FrameWriter {
 public:
  static constexpr std::size_t head_bytes = 12;  ///< before the payload of the first block

  FrameWriter() { bytes_ = "SLV1"; }

  void begin(Block block) {
    put(static_cast<std::uint16_t>(block));
    put(std::uint16_t{0});
    length_at_ = bytes_.size();
    put(std::uint32_t{0});
  }
  void end() {
    const auto length = static_cast<std::uint32_t>(bytes_.size() - length_at_ - 4);
    std::memcpy(bytes_.data() + length_at_, &length, sizeof length);
    pad();
  }
  void pad() { bytes_.resize((bytes_.size() + 3) & ~std::size_t{3}, '\0'); }

  template <class T>
  void put(T value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void put_f32(double value) { put(static_cast<float>(value)); }
  void put(std::initializer_list<double> values) {
    for (const double value : values) put(value);
  }
  void put_f32(std::initializer_list<double> values) {
    for (const double value : values) put_f32(value);
  }
  void put_pose(const maps::Pose& pose) { put({pose.x, pose.y, pose.yaw}); }
  /// Writes a body of the block `bodies`; its length and width in m.
  void put_body(std::size_t id, int kind, bool touched, const maps::Pose& at, double length, double width) {
    put(static_cast<std::uint16_t>(id));
    put(static_cast<std::uint8_t>(kind));
    put(static_cast<std::uint8_t>(touched));
    put_f32({at.x, at.y, at.yaw, length, width});
  }
  /// Writes the variance of the first input of each step, [step][input].
  void put_covariance(std::span<const float> variances, std::size_t inputs) {
    begin(Block::covariance);
    for (std::size_t row = 0; row < variances.size(); row += inputs) put(variances[row]);
    end();
  }

  /// Writes the block with a map: runs of equal cells, the value in the upper 8 bits, the length in the
  /// lower 24.
  void put_grid(const maps::OccupancyGrid& grid) {
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

  /// Begins a list of points with their origin and unit (m), of which 16 bits reach 32767 either way. Each
  /// point is stored as its difference to the one before, which compresses better.
  void begin_points(const maps::Point& origin, double unit = 0.001) {
    origin_ = origin;
    unit_ = unit;
    last_x_ = last_y_ = 0;
    put(origin.x);
    put(origin.y);
    put_f32(unit);
  }
  void put_point(const maps::Point& point) {
    put_difference(counts(point.x - origin_.x), last_x_);
    put_difference(counts(point.y - origin_.y), last_y_);
  }

  void append(std::string_view bytes) { bytes_ += bytes; }
  std::string take() { return std::move(bytes_); }
  /// Takes the blocks without the head of the message, to be appended to another message.
  std::string take_blocks() { return take().substr(4); }

 private:
  std::int16_t counts(double metres) const {
    const double value = std::round(metres / unit_);
    return static_cast<std::int16_t>(value > 32767 ? 32767 : value > -32767 ? value : -32767);
  }

  /// Stores a difference modulo 2^16, so that it always fits.
  void put_difference(std::int16_t now, std::int16_t& last) {
    put(static_cast<std::int16_t>(now - last));
    last = now;
  }

  std::string bytes_;
  std::size_t length_at_ = 0;
  maps::Point origin_;
  double unit_ = 0.001;
  std::int16_t last_x_ = 0, last_y_ = 0;
};

}  // namespace slalom::view
