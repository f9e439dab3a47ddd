#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slalom/maps/pose.hpp"

/// Foxglove messages as JSON. Lengths are rounded to 0.1 mm, and angles to 1e-6 rad.
namespace slalom::view::foxglove {

using Color = std::array<double, 4>;  ///< red, green, blue, opacity in [0, 1]

/// Returns the transform of the frame `child`, which is at `pose` in the frame `map`. `time`: ns.
std::string frame_transform(std::uint64_t time, const std::string& child, const maps::Pose& pose);

struct Scan {
  double angle_min = 0, angle_increment = 0;   ///< rad
  std::span<const std::uint16_t> millimetres;  ///< ranges
};
/// Returns a scan whose sensor is the origin of `frame`.
std::string laser_scan(std::uint64_t time, const std::string& frame, const Scan& scan);

/// Returns a grid with `columns` cells of one byte in each row. Its first cell has its corner at `corner` in
/// the frame `map`.
std::string grid(std::uint64_t time, const maps::Pose& corner, std::uint32_t columns, double cell_size,
                 const std::string& field, std::string_view cells);

/// A scene update: entities in the frame `map`. They replace earlier ones of the same name.
class Scene {
 public:
  explicit Scene(std::uint64_t time) : time_(time) {}

  /// Begins an entity; the shapes that follow are part of it.
  void begin(const std::string& id);
  void line(std::span<const maps::Point> points, const Color& color, double pixels, double height = 0);
  void box(const maps::Pose& pose, double length, double width, double height, const Color& color);
  void disc(const maps::Point& centre, double diameter, double height, const Color& color);
  void text(const maps::Point& at, double height, const std::string& words, const Color& color);
  std::string take();

 private:
  void end();

  std::uint64_t time_;
  std::string entities_, head_, cubes_, cylinders_, lines_, texts_;
};

/// Appends a number with at most `digits` decimals; 0 if it is not finite.
void append_number(std::string& to, double value, int digits = 4);

}  // namespace slalom::view::foxglove
