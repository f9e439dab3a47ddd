#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "json/json.hpp"
#include "slalom/maps/pose.hpp"

/// Foxglove messages. Lengths are rounded to 0.1 mm, and angles to 1e-6 rad; what is not finite is 0.
namespace slalom::view::foxglove {

using Color = std::array<double, 4>;  ///< red, green, blue, opacity in [0, 1]

/// Returns a time (ns) as seconds and nanoseconds.
Json timestamp(std::uint64_t time);

/// Returns the transform of the frame `child`, which is at `pose` in the frame `map`. `time`: ns.
Json frame_transform(std::uint64_t time, const std::string& child, const maps::Pose& pose);

/// Returns a scan whose sensor is the origin of `frame`. Angles in rad, ranges in mm.
Json laser_scan(std::uint64_t time, const std::string& frame, double angle_min, double angle_increment,
                std::span<const std::uint16_t> ranges);

/// Returns a grid with `columns` cells of one byte in each row. Its first cell has its corner at `corner` in
/// the frame `map`.
Json grid(std::uint64_t time, const maps::Pose& corner, std::uint32_t columns, double cell_size,
          const std::string& field, std::string_view cells);

/// A scene update: entities in the frame `map`. They replace earlier ones of the same name.
class Scene {
 public:
  explicit Scene(std::uint64_t time) : time_(time) {}

  /// Begins an entity; the shapes that follow are part of it.
  void begin(const std::string& id);
  void line(std::span<const maps::Point> points, const Color& color, double pixels);
  void box(const maps::Pose& pose, double length, double width, double height, const Color& color);
  void disc(const maps::Point& centre, double diameter, double height, const Color& color);
  void text(const maps::Point& at, double height, const std::string& words, const Color& color);
  Json message() const { return {{"deletions", Json::array()}, {"entities", entities_}}; }

 private:
  void add(const char* list, Json shape) { entities_.back()[list].push_back(std::move(shape)); }

  std::uint64_t time_;
  Json entities_ = Json::array();
};

}  // namespace slalom::view::foxglove
