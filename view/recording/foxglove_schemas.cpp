#include "view/recording/foxglove_schemas.hpp"

#include <utility>
#include <vector>

#include "src/evaluation/json.hpp"

namespace slalom::view::foxglove {
namespace {

using Fields = std::vector<std::pair<std::string, Json>>;

Json of_type(const char* name) {
  return {{"type", name}};
}
Json number() {
  return of_type("number");
}
Json text() {
  return of_type("string");
}
Json flag() {
  return of_type("boolean");
}
Json count() {
  return {{"type", "integer"}, {"minimum", 0}};
}
Json bytes() {
  return {{"type", "string"}, {"contentEncoding", "base64"}};
}
Json list(Json items) {
  return {{"type", "array"}, {"items", std::move(items)}};
}
Json one_of(int count) {
  Json values = Json::array();
  for (int i = 0; i < count; ++i) values.push_back({{"const", i}});
  return {{"oneOf", values}};
}
/// `all_needed`: the schemas ask for every field but those of times.
Json object(const Fields& fields, bool all_needed = true) {
  Json properties = Json::object(), needed = Json::array();
  for (const auto& [name, schema] : fields) {
    properties[name] = schema;
    needed.push_back(name);
  }
  Json json = {{"type", "object"}, {"properties", properties}};
  if (all_needed) json["required"] = needed;
  return json;
}
Json numbers(const std::vector<const char*>& names) {
  Fields fields;
  for (const char* name : names) fields.emplace_back(name, number());
  return object(fields);
}

Json nanoseconds() {
  return {{"type", "integer"}, {"minimum", 0}, {"maximum", 999999999}};
}
Json time() {
  return object({{"sec", count()}, {"nsec", nanoseconds()}}, false);
}
Json duration() {
  return object({{"sec", of_type("integer")}, {"nsec", nanoseconds()}}, false);
}
Json vector3() {
  return numbers({"x", "y", "z"});
}
Json quaternion() {
  return numbers({"x", "y", "z", "w"});
}
Json color() {
  return numbers({"r", "g", "b", "a"});
}
Json pose() {
  return object({{"position", vector3()}, {"orientation", quaternion()}});
}

Json arrow() {
  return object({{"pose", pose()},
                 {"shaft_length", number()},
                 {"shaft_diameter", number()},
                 {"head_length", number()},
                 {"head_diameter", number()},
                 {"color", color()}});
}
Json box() {
  return object({{"pose", pose()}, {"size", vector3()}, {"color", color()}});
}
Json cylinder() {
  return object({{"pose", pose()},
                 {"size", vector3()},
                 {"bottom_scale", number()},
                 {"top_scale", number()},
                 {"color", color()}});
}
Json line() {
  return object({{"type", one_of(3)},
                 {"pose", pose()},
                 {"thickness", number()},
                 {"scale_invariant", flag()},
                 {"points", list(vector3())},
                 {"color", color()},
                 {"colors", list(color())},
                 {"indices", list(count())}});
}
Json triangles() {
  return object({{"pose", pose()},
                 {"points", list(vector3())},
                 {"color", color()},
                 {"colors", list(color())},
                 {"indices", list(count())}});
}
Json label() {
  return object({{"pose", pose()},
                 {"billboard", flag()},
                 {"font_size", number()},
                 {"scale_invariant", flag()},
                 {"color", color()},
                 {"text", text()}});
}
Json model() {
  return object({{"pose", pose()},
                 {"scale", vector3()},
                 {"color", color()},
                 {"override_color", flag()},
                 {"url", text()},
                 {"media_type", text()},
                 {"data", bytes()}});
}
Json entity() {
  return object({{"timestamp", time()},
                 {"frame_id", text()},
                 {"id", text()},
                 {"lifetime", duration()},
                 {"frame_locked", flag()},
                 {"metadata", list(object({{"key", text()}, {"value", text()}}))},
                 {"arrows", list(arrow())},
                 {"cubes", list(box())},
                 {"spheres", list(box())},
                 {"cylinders", list(cylinder())},
                 {"lines", list(line())},
                 {"triangles", list(triangles())},
                 {"texts", list(label())},
                 {"models", list(model())}});
}

}  // namespace

std::string frame_transform_schema() {
  return object({{"timestamp", time()},
                 {"parent_frame_id", text()},
                 {"child_frame_id", text()},
                 {"translation", vector3()},
                 {"rotation", quaternion()}})
      .dump();
}

std::string grid_schema() {
  return object({{"timestamp", time()},
                 {"frame_id", text()},
                 {"pose", pose()},
                 {"column_count", count()},
                 {"cell_size", numbers({"x", "y"})},
                 {"row_stride", count()},
                 {"cell_stride", count()},
                 {"fields", list(object({{"name", text()}, {"offset", count()}, {"type", one_of(9)}}))},
                 {"data", bytes()}})
      .dump();
}

std::string laser_scan_schema() {
  return object({{"timestamp", time()},
                 {"frame_id", text()},
                 {"pose", pose()},
                 {"start_angle", number()},
                 {"end_angle", number()},
                 {"ranges", list(number())},
                 {"intensities", list(number())}})
      .dump();
}

std::string scene_update_schema() {
  const Json deletion = object({{"timestamp", time()}, {"type", one_of(2)}, {"id", text()}});
  return object({{"deletions", list(deletion)}, {"entities", list(entity())}}).dump();
}

}  // namespace slalom::view::foxglove
