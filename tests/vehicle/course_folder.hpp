#pragma once

#include "slalom/maps/ros_map.hpp"
#include "support/temporary_folder.hpp"

namespace slalom::testing {

/// A scratch folder that holds a small sound course until a test spoils it: a ring of 4 waypoints in a free
/// map of 10 x 10 m with a wall round it.
class CourseFolder {
 public:
  CourseFolder() {
    std::filesystem::create_directories(path_);
    maps::OccupancyGrid grid{100, 100, 0.1, {-5, -5, 0}, {}};
    grid.cells.assign(10000, maps::Occupancy::free);
    for (int i = 0; i < 100; ++i)
      grid.at(i, 0) = grid.at(i, 99) = grid.at(0, i) = grid.at(99, i) = maps::Occupancy::occupied;
    maps::save_ros_map(grid, path_ / "map.yaml");
    write("raceline.csv", raceline);
  }

  void write(const std::string& file, const std::string& text) const { std::ofstream(path_ / file) << text; }
  void remove(const std::string& file) const { std::filesystem::remove(path_ / file); }
  const std::filesystem::path& path() const { return path_; }

  static constexpr const char* raceline =
      "# made by hand\n"
      "# s_m; x_m; y_m; psi_rad; kappa_radpm; vx_mps; ax_mps2\n"
      "0; 2; 0; 9; 0; 1; 0\n"
      "2; 0; 2; 9; 0; 2; 0\n"
      "4; -2; 0; 9; 0; 3; 0\n"
      "6; 0; -2; 9; 0; 4; 0\n";

 private:
  ScopedFolder parent_;
  std::filesystem::path path_ = parent_.path() / "ring";
};

}  // namespace slalom::testing
