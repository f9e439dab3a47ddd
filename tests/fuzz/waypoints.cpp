// The CSV files of a course: its waypoints, in either format, and the places of its obstacles.
#include "fuzz/course_promise.hpp"
#include "fuzz/target.hpp"
#include "vehicle/course_folder.hpp"

namespace slalom::fuzz {
namespace {

std::vector<std::string> seeds() {
  const std::string points = "1.5,0.25\n-0.5,2\n-2,-1e-1\n";
  return {testing::CourseFolder::raceline + std::string(1, separator) + points,
          "opt_x,opt_y,width,ref_v\n2,0,1,1.5\n0,2,1,2\n-2,0,1,0\n0,-2,1,3\n" + std::string(1, separator) +
              points};
}

bool run(std::string_view bytes) {
  static const testing::CourseFolder ring;
  const auto [waypoints, obstacles] = split<2>(bytes);
  ring.write("raceline.csv", std::string(waypoints));
  ring.write("opp_ref_path.csv", std::string(obstacles));
  return check_course_of(ring.path());
}

const Target target("waypoints", 4096, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
