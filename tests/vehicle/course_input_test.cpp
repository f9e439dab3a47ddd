// Spoiled course folders: each is refused with file, line, key or column, and rule.

#include <functional>

#include "slalom/core/error.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "support/thrown_words.hpp"
#include "vehicle/course_folder.hpp"

namespace slalom::vehicle::course_input_test {
namespace {

using testing::CourseFolder;

struct Spoiled {
  const char* name;
  std::function<void(const CourseFolder&)> spoil;
  std::vector<const char*> message;  ///< what the error must contain
};

std::function<void(const CourseFolder&)> rows(const char* text) {
  return [text](const CourseFolder& folder) {
    folder.write("raceline.csv",
                 std::string("# s_m; x_m; y_m; psi_rad; kappa_radpm; vx_mps; ax_mps2\n") + text);
  };
}

std::function<void(const CourseFolder&)> file(const char* name, const char* text) {
  return [name, text](const CourseFolder& folder) { folder.write(name, text); };
}

std::function<void(const CourseFolder&)> yaml(const char* text) {
  return file("course.yaml", text);
}

std::function<void(const CourseFolder&)> without(const char* name) {
  return [name](const CourseFolder& folder) { folder.remove(name); };
}

const std::vector<Spoiled>& cases() {
  static const std::vector<Spoiled> all = {
      {"no_folder",
       [](const CourseFolder& f) { std::filesystem::remove_all(f.path()); },
       {"ring", "not a folder"}},
      {"no_map", without("map.yaml"), {"ring", "no map"}},
      {"no_image", without("map.png"), {"map.png"}},
      {"two_maps",
       file("other.yaml", "image: map.png\nresolution: 0.1\n"),
       {"more than one map", "other.yaml"}},
      {"corrupt_map", file("map.yaml", "image: [map.png\n"), {"map.yaml"}},
      {"corrupt_image", file("map.png", "\x89PNG\r\n\x1a\nbroken"), {"map.png"}},
      {"no_waypoints", without("raceline.csv"), {"no waypoint file"}},
      {"two_waypoint_files",
       file("more.csv", CourseFolder::raceline),
       {"more than one waypoint", "more.csv"}},
      {"empty_file", file("raceline.csv", ""), {"no waypoint file", "raceline.csv is ignored"}},
      {"commas",
       file("raceline.csv", "0,2,0,9,0,1,0\n2,0,2,9,0,2,0\n4,-2,0,9,0,3,0\n"),
       {"no waypoint file", "raceline.csv is ignored"}},
      {"map_without_image",
       file("map.yaml", "resolution: 0.1\n"),
       {"no map", "map.yaml is ignored: it names no map image"}},
      {"waypoint_off_the_map",
       rows("0;2;0;9;0;1;0\n2;0;2;9;0;2;0\n4;-102;0;9;0;3;0\n"),
       {"raceline.csv:4:", "(-102", "on the map"}},
      {"no_speed_at_all",
       rows("0;2;0;9;0;0;0\n2;0;2;9;0;0;0\n4;-2;0;9;0;0;0\n"),
       {"raceline.csv:2:", "vx_mps", "0 in every row", "above 0"}},
      {"column_twice",
       file("raceline.csv", "opt_x,opt_y,ref_v,ref_v\n1,2,3,4\n2,2,3,4\n2,3,3,4\n"),
       {"raceline.csv:1:", "ref_v", "twice"}},
      {"map_key_twice",
       file("map.yaml", "image: map.png\nresolution: 0.1\norigin: [-5, -5, 0]\nresolution: 0.2\n"),
       {"map.yaml:4:", "`resolution`", "duplicate"}},
      {"no_rows", rows(""), {"raceline.csv", "0 waypoints", "at least 3"}},
      {"two_rows", rows("0;0;0;0;0;1;0\n0;1;0;0;0;1;0\n"), {"2 waypoints", "at least 3"}},
      {"two_rows_and_the_first_again",
       rows("0;0;0;0;0;1;0\n0;1;0;0;0;1;0\n0;0;0;0;0;1;0\n"),
       {"2 waypoints", "at least 3"}},
      {"nan", rows("0;0;0;0;0;1;0\n0;nan;0;0;0;1;0\n"), {"raceline.csv:3:", "x_m", "nan", "finite"}},
      {"overflow", rows("0;1e999;0;0;0;1;0\n"), {"raceline.csv:2:", "x_m", "1e999"}},
      {"no_number", rows("0;1;zwei;0;0;1;0\n"), {"raceline.csv:2:", "y_m", "'zwei'"}},
      {"empty_cell", rows("0;1; ;0;0;1;0\n"), {"raceline.csv:2:", "y_m", "''"}},
      {"wrong_columns", rows("0;0;0;0;0;1;0\n0;1;0;0;1;0\n"), {"raceline.csv:3:", "6 columns", "7"}},
      {"negative_speed", rows("0;0;0;0;0;-1;0\n"), {"raceline.csv:2:", "vx_mps", "-1", "at least 0"}},
      {"repeated_point",
       rows("0;0;0;0;0;1;0\n0;1;0;0;0;1;0\n0;1;0;0;0;1;0\n0;2;0;0;0;1;0\n"),
       {"raceline.csv:4:", "differ"}},
      {"shorter_than_a_car",
       rows("0;1e-9;0;0;0;1;0\n0;0;1e-9;0;0;1;0\n0;-1e-9;0;0;0;1;0\n"),
       {"raceline.csv", "m long", "at least 0.1 m"}},
      {"header_without_speed",
       file("raceline.csv", "opt_x,opt_y,speed\n1,2,3\n"),
       {"raceline.csv:1:", "ref_v", "missing"}},
      {"optimised_line_columns",
       file("raceline.csv", "opt_x,opt_y,ref_v\n1,2,3\n1,2\n"),
       {"raceline.csv:3:", "2 columns", "3"}},
      {"obstacle_cell", file("opp_ref_path.csv", "1,2\n1,x\n"), {"opp_ref_path.csv:2:", "1 (y)", "'x'"}},
      {"obstacle_columns", file("opp_ref_path.csv", "1\n"), {"opp_ref_path.csv:1:", "x and y"}},
      {"obstacle_none", file("opp_ref_path.csv", "\n"), {"opp_ref_path.csv", "at least one point"}},
      {"course_syntax", yaml("name: x\nstart: {x: 1\n"), {"course.yaml", "YAML"}},
      {"course_list", yaml("- 1\n"), {"course.yaml:1:", "map of keys"}},
      {"course_key", yaml("name: x\nstrat: 1\n"), {"course.yaml:2:", "strat", "unknown key"}},
      {"course_key_twice",
       yaml("closed: true\nname: x\nclosed: false\n"),
       {"course.yaml:3:", "closed", "duplicate key"}},
      {"no_value", yaml("timeout:\nname: x\n"), {"course.yaml:1:", "timeout", "must have a value"}},
      {"start_key", yaml("start: {x: 1, y: 1, jaw: 0}\n"), {"course.yaml:1:", "start.jaw"}},
      {"start_missing", yaml("start: {x: 1, y: 1}\n"), {"course.yaml:1:", "start.yaw", "missing"}},
      {"start_type", yaml("\nstart: 3\n"), {"course.yaml:2:", "start", "{x, y, yaw}"}},
      {"start_too_far",
       yaml("start: {x: 1, y: 1, yaw: 1e7}\n"),
       {"course.yaml:1:", "start", "within 1e6 rad"}},
      {"start_in_wall",
       yaml("name: x\nstart: {x: 4.95, y: 0, yaw: 0}\n"),
       {"course.yaml:2:", "start", "wall"}},
      {"start_off_map", yaml("start: {x: 99, y: 0, yaw: 0}\n"), {"course.yaml:1:", "on the map"}},
      {"timeout", yaml("timeout: 0\n"), {"course.yaml:1:", "timeout", "'0'", "above 0"}},
      {"closed", yaml("closed: maybe\n"), {"course.yaml:1:", "closed", "'maybe'", "true or false"}},
  };
  return all;
}

class CorruptCourse : public ::testing::TestWithParam<std::size_t> {};

TEST_P(CorruptCourse, IsRejectedWithAClearMessage) {
  const CourseFolder folder;
  ASSERT_NO_THROW(load_course(folder.path())) << "sound before it is spoiled";
  const Spoiled& spoiled = cases()[GetParam()];
  spoiled.spoil(folder);
  expect_error_with<IoError>(spoiled.message, [&] { load_course(folder.path()); });
}

INSTANTIATE_TEST_SUITE_P(BadInput, CorruptCourse, ::testing::Range<std::size_t>(0, cases().size()),
                         [](const auto& test) { return std::string(cases()[test.param].name); });

TEST(KnownCourse, RejectsACorruptTable) {
  const CourseFolder folder;
  for (const char* table : {"berlin: {start: {x: 0, y: 0, yaw: 0}, timeout: -1}\n", "berlin: 5\n", "[1]\n"}) {
    folder.write("known.yaml", table);
    EXPECT_THROW(known_course("berlin", {folder.path()}), IoError) << table;
  }
}

}  // namespace
}  // namespace slalom::vehicle::course_input_test
