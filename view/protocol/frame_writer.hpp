#pragma once

#include <cstring>
#include <initializer_list>
#include <string>
#include <string_view>

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
  ghost_frame = 11,
  others = 12,
  figure = 13,
  polygons = 14,
  lines = 19,
  grid = 20,
  path = 21,
  past = 22,
  file = 30,
};

/// The words of a text.
std::vector<std::string> words_of(const char* text);

/// Writes a binary message: "SLV1", then blocks of kind (u16), 0 (u16), length (u32) and payload, padded with
/// zeros to four bytes. Numbers are little-endian, as in the memory of all supported machines.
class FrameWriter {
 public:
  static constexpr std::size_t head_bytes = 12;  ///< before the payload of the first block

  FrameWriter() { bytes_ = "SLV1"; }

  void begin(Block block);
  void end();
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
  /// Writes the block with a map: runs of equal cells, values in the upper 8 bits, lengths in the lower 24.
  void put_grid(const maps::OccupancyGrid& grid);

  /// Begins a list of points with their origin and unit (m), of which 16 bits reach 32767 either way. Each
  /// point is stored as its difference to the one before, which compresses better.
  void begin_points(const maps::Point& origin, double unit = 0.001);
  void put_point(const maps::Point& point);

  void append(std::string_view bytes) { bytes_ += bytes; }
  std::string take() { return std::move(bytes_); }
  /// Takes the blocks without the head of the message, to be appended to another message.
  std::string take_blocks() { return take().substr(4); }

 private:
  std::int16_t counts(double metres) const;
  void put_difference(std::int16_t now, std::int16_t& last);

  std::string bytes_;
  std::size_t length_at_ = 0;
  maps::Point origin_;
  double unit_ = 0.001;
  std::int16_t last_x_ = 0, last_y_ = 0;
};

}  // namespace slalom::view
