#include "view/recording/foxglove_messages.hpp"

#include <charconv>
#include <cmath>
#include <utility>

#include "src/evaluation/json.hpp"
#include "view/recording/encodings.hpp"

namespace slalom::view::foxglove {
namespace {

constexpr int angle_digits = 6;

std::string timestamp(std::uint64_t time) {
  constexpr std::uint64_t second = 1'000'000'000;
  return "{\"sec\":" + std::to_string(time / second) + ",\"nsec\":" + std::to_string(time % second) + "}";
}

std::string quoted(const std::string& text) {
  return json_text(text);
}

void append_vector(std::string& to, double x, double y, double z) {
  to += "{\"x\":";
  append_number(to, x);
  to += ",\"y\":";
  append_number(to, y);
  to += ",\"z\":";
  append_number(to, z);
  to += '}';
}

std::string rotation(double yaw) {
  std::string to = "{\"x\":0,\"y\":0,\"z\":";
  append_number(to, std::sin(0.5 * yaw), angle_digits);
  to += ",\"w\":";
  append_number(to, std::cos(0.5 * yaw), angle_digits);
  return to + "}";
}

std::string pose_json(const maps::Pose& pose, double height) {
  std::string to = "{\"position\":";
  append_vector(to, pose.x, pose.y, height);
  return to + ",\"orientation\":" + rotation(pose.yaw) + "}";
}

std::string color_json(const Color& color) {
  std::string to;
  const char* const names[] = {"{\"r\":", ",\"g\":", ",\"b\":", ",\"a\":"};
  for (std::size_t i = 0; i < 4; ++i) append_number(to += names[i], color[i], 3);
  return to + "}";
}

std::string& next(std::string& list) {
  if (!list.empty()) list += ',';
  return list;
}

}  // namespace

void append_number(std::string& to, double value, int digits) {
  char buffer[64];
  const bool fits = std::abs(value) < 1e40;  // neither infinite nor NaN either
  char* end =
      std::to_chars(buffer, buffer + sizeof buffer, fits ? value : 0, std::chars_format::fixed, digits).ptr;
  if (digits > 0) {
    while (end[-1] == '0') --end;
    if (end[-1] == '.') --end;
  }
  const std::string_view text(buffer, static_cast<std::size_t>(end - buffer));
  to += text == "-0" ? "0" : text;
}

std::string frame_transform(std::uint64_t time, const std::string& child, const maps::Pose& pose) {
  std::string json = "{\"timestamp\":" + timestamp(time) +
                     ",\"parent_frame_id\":\"map\",\"child_frame_id\":" + quoted(child) + ",\"translation\":";
  append_vector(json, pose.x, pose.y, 0);
  return json + ",\"rotation\":" + rotation(pose.yaw) + "}";
}

std::string laser_scan(std::uint64_t time, const std::string& frame, const Scan& scan) {
  const double intervals = scan.millimetres.empty() ? 0.0 : static_cast<double>(scan.millimetres.size() - 1);
  std::string json = "{\"timestamp\":" + timestamp(time) + ",\"frame_id\":" + quoted(frame) +
                     ",\"pose\":" + pose_json({}, 0) + ",\"start_angle\":";
  append_number(json, scan.angle_min, angle_digits);
  json += ",\"end_angle\":";
  append_number(json, scan.angle_min + intervals * scan.angle_increment, angle_digits);
  json += ",\"ranges\":[";
  for (std::size_t i = 0; i < scan.millimetres.size(); ++i) {
    if (i > 0) json += ',';
    append_number(json, 0.001 * scan.millimetres[i], 3);
  }
  return json + "],\"intensities\":[]}";
}

std::string grid(std::uint64_t time, const maps::Pose& corner, std::uint32_t columns, double cell_size,
                 const std::string& field, std::string_view cells) {
  constexpr int uint8 = 1;  // number of the type in PackedElementField
  std::string json = "{\"timestamp\":" + timestamp(time) +
                     ",\"frame_id\":\"map\",\"pose\":" + pose_json(corner, 0) +
                     ",\"column_count\":" + std::to_string(columns) + ",\"cell_size\":{\"x\":";
  append_number(json, cell_size, angle_digits);
  json += ",\"y\":";
  append_number(json, cell_size, angle_digits);
  json += "},\"row_stride\":" + std::to_string(columns) +
          ",\"cell_stride\":1,\"fields\":[{\"name\":" + quoted(field) +
          ",\"offset\":0,\"type\":" + std::to_string(uint8) + "}],\"data\":\"";
  return json + base64(cells) + "\"}";
}

void Scene::begin(const std::string& id) {
  end();
  head_ = "{\"timestamp\":" + timestamp(time_) + ",\"frame_id\":\"map\",\"id\":" + quoted(id) +
          ",\"lifetime\":{\"sec\":0,\"nsec\":0},\"frame_locked\":false,\"metadata\":[],\"arrows\":[],";
}

void Scene::end() {
  if (head_.empty()) return;
  next(entities_) += std::exchange(head_, {}) + "\"cubes\":[" + std::exchange(cubes_, {}) +
                     "],\"spheres\":[],\"cylinders\":[" + std::exchange(cylinders_, {}) + "],\"lines\":[" +
                     std::exchange(lines_, {}) + "],\"triangles\":[],\"texts\":[" +
                     std::exchange(texts_, {}) + "],\"models\":[]}";
}

void Scene::line(std::span<const maps::Point> points, const Color& color, double pixels, double height) {
  next(lines_) += "{\"type\":0,\"pose\":" + pose_json({}, height) + ",\"thickness\":";
  append_number(lines_, pixels, 2);
  lines_ += ",\"scale_invariant\":true,\"points\":[";
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) lines_ += ',';
    append_vector(lines_, points[i].x, points[i].y, 0);
  }
  lines_ += "],\"color\":" + color_json(color) + ",\"colors\":[],\"indices\":[]}";
}

void Scene::box(const maps::Pose& pose, double length, double width, double height, const Color& color) {
  next(cubes_) += "{\"pose\":" + pose_json(pose, 0.5 * height) + ",\"size\":";
  append_vector(cubes_, length, width, height);
  cubes_ += ",\"color\":" + color_json(color) + "}";
}

void Scene::disc(const maps::Point& centre, double diameter, double height, const Color& color) {
  next(cylinders_) += "{\"pose\":" + pose_json({centre.x, centre.y, 0}, 0.5 * height) + ",\"size\":";
  append_vector(cylinders_, diameter, diameter, height);
  cylinders_ += ",\"bottom_scale\":1,\"top_scale\":1,\"color\":" + color_json(color) + "}";
}

void Scene::text(const maps::Point& at, double height, const std::string& words, const Color& color) {
  next(texts_) +=
      "{\"pose\":" + pose_json({at.x, at.y, 0}, height) +
      ",\"billboard\":true,\"font_size\":14,\"scale_invariant\":true,\"color\":" + color_json(color) +
      ",\"text\":" + quoted(words) + "}";
}

std::string Scene::take() {
  end();
  return "{\"deletions\":[],\"entities\":[" + std::exchange(entities_, {}) + "]}";
}

}  // namespace slalom::view::foxglove
