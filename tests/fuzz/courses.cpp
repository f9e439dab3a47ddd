// Images of maps, the files of a course, centre lines and cars.
#include <cmath>
#include <optional>
#include <stdexcept>

#include "fuzz/target.hpp"
#include "slalom/evaluation/lap.hpp"
#include "slalom/maps/image.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/course/course_check.hpp"
#include "slalom/vehicle/racing/race_course.hpp"
#include "support/promise.hpp"
#include "support/temporary_folder.hpp"
#include "vehicle/course_folder.hpp"
#include "vehicle/planner/planner_calls.hpp"

namespace slalom::fuzz {
namespace {

/// Loads a course, and checks that it can be driven. Throws IoError.
void check_course_of(const std::filesystem::path& folder) {
  const vehicle::Course course = vehicle::load_course(folder);
  require(course.waypoints.size() >= 3, "a course has three waypoints");
  for (const vehicle::Waypoint& at : course.waypoints)
    require(std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.yaw) && at.speed >= 0 &&
                std::isfinite(at.speed) && std::isfinite(at.arc_length),
            "waypoints are finite");
  require(course.length > 0 && std::isfinite(course.length), "the length of a course is finite and above 0");
  require(std::isfinite(course.start.x) && std::isfinite(course.start.y) && std::isfinite(course.start.yaw),
          "the start is finite");
  require(!course.obstacle_path.empty(), "obstacles have places");
  const vehicle::CourseCheck check = vehicle::check_course(course, {});
  for (const vehicle::CourseFinding& finding : {check.walls, check.grip})
    require(finding.share >= 0 && finding.share <= 1 + 1e-9, "a share is within 0 and 1");
}

const Target image_target(
    "image", 1 << 14,
    []() -> Seeds {
      maps::GreyImage image{5, 4, {}, {}};
      for (int i = 0; i < 20; ++i) image.grey.push_back(static_cast<std::uint8_t>(12 * i));
      const auto png = scratch_folder().path() / "seed.png";
      maps::save_png(image, png);
      return {testing::content(png), "P5\n# by hand\n3 2\n255\nabcdef", "P2\n3 2\n15\n0 1 2\n13 14 15\n"};
    },
    [](std::string_view bytes) {
      const maps::GreyImage image = maps::load_image(scratch_file("image", bytes));
      const auto pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
      require(image.width > 0 && image.height > 0 && image.grey.size() == pixels, "an image has its pixels");
      require(image.opacity.empty() || image.opacity.size() == pixels,
              "an image has the opacity of its pixels");
      return true;
    });

/// The first second of a lap on a course, and its commands' promises. Returns whether a car can drive there.
bool drive(const std::filesystem::path& folder) {
  static const vehicle::Configuration configuration = [] {
    auto made = vehicle::load_configuration(SLALOM_CONFIGS "/default.yaml");
    vehicle::set_option(made, "svg_mppi.samples", "32");
    return made;
  }();
  std::optional<evaluation::LapDrive> lap;
  try {
    const auto environment =
        evaluation::load_environment(folder, evaluation::Protocol::true_physics, {folder});
    lap.emplace(evaluation::LapSetup{environment, {configuration}}, 0);
  } catch (const std::invalid_argument&) {
    return false;
  }
  for (int i = 0; i < 40; ++i) {
    const testing::CallLimits limits;
    lap->step([](const evaluation::ControlStep& step) {
      testing::check_output(step.output, configuration.planner);
      require(std::isfinite(step.cost.state + step.cost.collision), "costs are finite");
    });
    limits.check();
  }
  return true;
}

const Target course_target(
    "course", 8192,
    []() -> Seeds {
      const testing::CourseFolder ring;
      const std::string map = testing::content(ring.path() / "map.yaml");
      const std::string course =
          "name: \"ring\"\ndescription: \"by hand\"\ncommand: \"slalom track\"\nstart: {x: 2, y: 0, yaw: "
          "1.5}\n"
          "timeout: 30\nclosed: true\n";
      const std::string known = "ring:\n  start: {x: 2, y: 0, yaw: 1.57}\n  timeout: 60\n";
      const std::string points = "1.5,0.25\n-0.5,2\n-2,-1e-1\n";
      return {map + separator + course + separator + known + separator + testing::CourseFolder::raceline +
                  separator + points,
              map + separator + course + separator + known + separator +
                  "opt_x,opt_y,width,ref_v\n2,0,1,1.5\n0,2,1,2\n-2,0,1,0\n0,-2,1,3\n" + separator + points,
              "image: map.png\nresolution: 0.1\norigin: [-5.0, -5.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
              "free_thresh: 0.196\nmode: scale\n" +
                  std::string(1, separator) + "start: {x: 2, y: 0}\nclosed: false\n"};
    },
    [](std::string_view bytes) {
      static const testing::CourseFolder ring;
      const auto [map, course, known, waypoints, obstacles] = split<5>(bytes);
      ring.write("map.yaml", std::string(map));
      ring.write("course.yaml", std::string(course));
      ring.write("known.yaml", std::string(known));
      ring.write("raceline.csv",
                 waypoints.empty() ? testing::CourseFolder::raceline : std::string(waypoints));
      ring.remove("opp_ref_path.csv");
      if (!obstacles.empty()) ring.write("opp_ref_path.csv", std::string(obstacles));
      const bool is_known = is_valid([&] {
        const auto found = vehicle::known_course("ring", {ring.path()});
        require(!found || (std::isfinite(found->start.x) && found->timeout >= 0),
                "a known course has a start and a timeout");
      });
      check_course_of(ring.path());
      return drive(ring.path()) && is_known;
    },
    200);

/// The minimum-time line, where the corridor is small enough for a test.
void solve(const vehicle::CentreLineFile& file, const vehicle::RacingCar& car) {
  const auto corridor =
      vehicle::corridor_from_widths(file.line.points, file.left, file.right, file.line.closed, 1);
  if (corridor.centre_line.size() > 60) return;
  for (const auto& point : vehicle::minimum_time_raceline(corridor, car).points)
    require(point.speed > 0 && point.speed <= car.limits.top_speed, "speeds are within the limits");
}

const Target racing_target(
    "racing", 4096,
    []() -> Seeds {
      return {"# x_m, y_m, w_tr_right_m, w_tr_left_m\n5, 0, 2, 2\n0, 5, 2, 2\n-5, 0, 2, 2\n0, -5, 2, 2\n",
              "x;y\n1;2\n2;2.5\n3;2\n4;4e0\n"};
    },
    [](std::string_view bytes) {
      const auto file = vehicle::read_centre_line(scratch_file("line.csv", bytes));
      require(file.left.size() == file.right.size(), "widths come in pairs");
      if (file.left.empty()) return true;
      require(file.left.size() == file.line.points.size(), "every point has its widths");
      try {
        solve(file, {});
      } catch (const std::invalid_argument&) {
        // The files are valid, the corridor is not.
      }
      return true;
    });

}  // namespace
}  // namespace slalom::fuzz
