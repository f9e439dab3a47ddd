// The YAML files of a course: map.yaml, course.yaml and the table known.yaml.
#include <cmath>

#include "fuzz/course_promise.hpp"
#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"
#include "support/temporary_folder.hpp"
#include "vehicle/course_folder.hpp"

namespace slalom::fuzz {
namespace {

std::vector<std::string> seeds() {
  const testing::CourseFolder ring;
  const std::string map = testing::content(ring.path() / "map.yaml");
  const std::string course =
      "name: \"ring\"\ndescription: \"by hand\"\ncommand: \"slalom track\"\nstart: {x: 2, y: 0, yaw: 1.5}\n"
      "timeout: 30\nclosed: true\n";
  const std::string known = "ring:\n  start: {x: 2, y: 0, yaw: 1.57}\n  timeout: 60\n";
  return {map + separator + course + separator + known,
          "image: map.png\nresolution: 0.1\norigin: [-5.0, -5.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
          "free_thresh: 0.196\nmode: scale\n" +
              std::string(1, separator) + "start: {x: 2, y: 0}\nclosed: false\n"};
}

bool run(std::string_view bytes) {
  static const testing::CourseFolder ring;
  const auto [map, course, known] = split<3>(bytes);
  ring.write("map.yaml", std::string(map));
  ring.write("course.yaml", std::string(course));
  ring.write("known.yaml", std::string(known));
  bool valid = check_course_of(ring.path());
  try {
    const auto found = vehicle::known_course("ring", {ring.path()});
    if (found)
      require(std::isfinite(found->start.x) && found->timeout >= 0,
              "a known course has a start and a timeout");
  } catch (const IoError&) {
    valid = false;
  }
  return valid;
}

const Target target("course", 4096, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
