#include "slalom/maps/ros_map.hpp"
#include "slalom/vehicle/racing/race_course.hpp"
#include "vehicle/course/course_csv.hpp"
#include "vehicle/course/course_text.hpp"

namespace slalom::vehicle {
namespace {

constexpr int decimals = 6;  // curvatures are second differences of the coordinates

}  // namespace

void save_race_course(const RaceCourse& course, const std::filesystem::path& folder,
                      const TrackLabel& label) {
  detail::make_folder(folder);
  maps::save_ros_map(course.map, folder / "map.yaml");
  detail::write_file(folder / "raceline.csv", detail::raceline_text(course.raceline.points, decimals));
  const Corridor& corridor = course.corridor;
  std::string text = detail::centre_line_header + std::string("\n");
  for (std::size_t i = 0; i < corridor.centre_line.size(); ++i)
    text += detail::fixed(corridor.centre_line[i].x, decimals) + ", " +
            detail::fixed(corridor.centre_line[i].y, decimals) + ", " +
            detail::fixed(corridor.right[i], decimals) + ", " + detail::fixed(corridor.left[i], decimals) +
            "\n";
  detail::write_file(folder / "centerline.csv", text);
  detail::write_file(folder / "course.yaml",
                     detail::course_text("course", label, course.start, corridor.closed));
}

}  // namespace slalom::vehicle
