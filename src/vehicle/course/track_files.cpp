#include "slalom/maps/ros_map.hpp"
#include "slalom/vehicle/course/track_generator.hpp"
#include "vehicle/course/course_text.hpp"

namespace slalom::vehicle {

namespace fs = std::filesystem;

void save_track(const GeneratedTrack& track, const fs::path& folder, const TrackLabel& label) {
  detail::make_folder(folder);
  maps::save_ros_map(track.map, folder / "map.yaml");
  detail::write_file(folder / "raceline.csv", detail::raceline_text(track.raceline, 4));
  std::string obstacles;
  for (const maps::Point& point : track.obstacle_path)
    obstacles += detail::fixed(point.x, 4) + "," + detail::fixed(point.y, 4) + "\n";
  detail::write_file(folder / "opp_ref_path.csv", obstacles);
  const RacelinePoint& first = track.raceline.front();
  detail::write_file(folder / "course.yaml",
                     detail::course_text("track", label, {first.x, first.y, first.yaw}, true));
}

}  // namespace slalom::vehicle
