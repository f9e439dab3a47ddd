// Centre lines and cars, which `slalom course` reads.
#include <stdexcept>

#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"
#include "slalom/vehicle/racing/race_course.hpp"

namespace slalom::fuzz {
namespace {

std::vector<std::string> seeds() {
  const std::string car = "base: passenger\nwidth: 1.4\nmargin: 0\nggv: [[0, 6, 8, 9], [30, 3, 8, 9.5]]\n";
  return {"# x_m, y_m, w_tr_right_m, w_tr_left_m\n5, 0, 2, 2\n0, 5, 2, 2\n-5, 0, 2, 2\n0, -5, 2, 2\n" +
              std::string(1, separator) + car,
          "x;y\n1;2\n2;2.5\n3;2\n4;4e0\n" + std::string(1, separator) + "top_speed: 3\npower: 9\n"};
}

/// The minimum-time line, where the corridor is small enough for a test.
void solve(const vehicle::CentreLineFile& file, const vehicle::RacingCar& car) {
  const auto corridor =
      vehicle::corridor_from_widths(file.line.points, file.left, file.right, file.line.closed, 1);
  if (corridor.centre_line.size() > 60) return;
  for (const auto& point : vehicle::minimum_time_raceline(corridor, car).points)
    require(point.speed > 0 && point.speed <= car.limits.top_speed, "speeds are within the limits");
}

bool run(std::string_view bytes) {
  const auto [line, car_text] = split<2>(bytes);
  try {
    const auto car = vehicle::load_racing_car(scratch_file("car.yaml", car_text));
    const auto file = vehicle::read_centre_line(scratch_file("line.csv", line));
    require(file.left.size() == file.right.size(), "widths come in pairs");
    if (file.left.empty()) return true;
    require(file.left.size() == file.line.points.size(), "every point has its widths");
    try {
      solve(file, car);
    } catch (const std::invalid_argument&) {
      // The files are valid, the corridor is not.
    }
    return true;
  } catch (const IoError&) {
    return false;
  }
}

const Target target("racing", 4096, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
