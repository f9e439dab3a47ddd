#include "view/recording/foxglove_messages.hpp"

#include "view/recording/encodings.hpp"

namespace slalom::view::foxglove {
namespace {

constexpr double length_unit = 1e-4, angle_unit = 1e-6, color_unit = 1e-3;

double rounded(double value, double unit = length_unit) {
  const double inverse = std::round(1 / unit);
  return std::abs(value) < 1e40 ? std::round(value * inverse) / inverse + 0.0 : 0;  // + 0.0: no -0
}

Json vector(double x, double y, double z) {
  return {{"x", rounded(x)}, {"y", rounded(y)}, {"z", rounded(z)}};
}

Json rotation(double yaw) {
  return {{"x", 0},
          {"y", 0},
          {"z", rounded(std::sin(0.5 * yaw), angle_unit)},
          {"w", rounded(std::cos(0.5 * yaw), angle_unit)}};
}

Json pose_json(const maps::Pose& pose, double height) {
  return {{"position", vector(pose.x, pose.y, height)}, {"orientation", rotation(pose.yaw)}};
}

Json color_json(const Color& color) {
  Json json;
  const char* const names[] = {"r", "g", "b", "a"};
  for (std::size_t i = 0; i < 4; ++i) json[names[i]] = rounded(color[i], color_unit);
  return json;
}

}  // namespace

Json timestamp(std::uint64_t time) {
  constexpr std::uint64_t second = 1'000'000'000;
  return {{"sec", time / second}, {"nsec", time % second}};
}

Json frame_transform(std::uint64_t time, const std::string& child, const maps::Pose& pose) {
  return {{"timestamp", timestamp(time)},
          {"parent_frame_id", "map"},
          {"child_frame_id", child},
          {"translation", vector(pose.x, pose.y, 0)},
          {"rotation", rotation(pose.yaw)}};
}

Json laser_scan(std::uint64_t time, const std::string& frame, double angle_min, double angle_increment,
                std::span<const std::uint16_t> ranges) {
  const double intervals = ranges.empty() ? 0.0 : static_cast<double>(ranges.size() - 1);
  Json metres = Json::array();
  for (const std::uint16_t range : ranges) metres.push_back(range / 1000.0);
  return {{"timestamp", timestamp(time)},
          {"frame_id", frame},
          {"pose", pose_json({}, 0)},
          {"start_angle", rounded(angle_min, angle_unit)},
          {"end_angle", rounded(angle_min + intervals * angle_increment, angle_unit)},
          {"ranges", std::move(metres)},
          {"intensities", Json::array()}};
}

Json grid(std::uint64_t time, const maps::Pose& corner, std::uint32_t columns, double cell_size,
          const std::string& field, std::string_view cells) {
  constexpr int uint8 = 1;  // number of the type in PackedElementField
  const double size = rounded(cell_size, angle_unit);
  const Json fields = Json::array({{{"name", field}, {"offset", 0}, {"type", uint8}}});
  return {{"timestamp", timestamp(time)},
          {"frame_id", "map"},
          {"pose", pose_json(corner, 0)},
          {"column_count", columns},
          {"cell_size", {{"x", size}, {"y", size}}},
          {"row_stride", columns},
          {"cell_stride", 1},
          {"fields", fields},
          {"data", base64(cells)}};
}

void Scene::begin(const std::string& id) {
  Json entity = {{"timestamp", timestamp(time_)},
                 {"frame_id", "map"},
                 {"id", id},
                 {"lifetime", timestamp(0)},
                 {"frame_locked", false}};
  for (const char* list :
       {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models"})
    entity[list] = Json::array();
  entities_.push_back(std::move(entity));
}

void Scene::line(std::span<const maps::Point> points, const Color& color, double pixels) {
  Json places = Json::array();
  for (const maps::Point& point : points) places.push_back(vector(point.x, point.y, 0));
  add("lines", {{"type", 0},
                {"pose", pose_json({}, 0)},
                {"thickness", pixels},
                {"scale_invariant", true},
                {"points", std::move(places)},
                {"color", color_json(color)},
                {"colors", Json::array()},
                {"indices", Json::array()}});
}

void Scene::box(const maps::Pose& pose, double length, double width, double height, const Color& color) {
  add("cubes", {{"pose", pose_json(pose, 0.5 * height)},
                {"size", vector(length, width, height)},
                {"color", color_json(color)}});
}

void Scene::disc(const maps::Point& centre, double diameter, double height, const Color& color) {
  add("cylinders", {{"pose", pose_json({centre.x, centre.y, 0}, 0.5 * height)},
                    {"size", vector(diameter, diameter, height)},
                    {"bottom_scale", 1},
                    {"top_scale", 1},
                    {"color", color_json(color)}});
}

void Scene::text(const maps::Point& at, double height, const std::string& words, const Color& color) {
  add("texts", {{"pose", pose_json({at.x, at.y, 0}, height)},
                {"billboard", true},
                {"font_size", 14},
                {"scale_invariant", true},
                {"color", color_json(color)},
                {"text", words}});
}

}  // namespace slalom::view::foxglove
