
#include "sim/golden_table.hpp"
#include "sim/gym_world.hpp"
#include "slalom/sim/lidar.hpp"

namespace slalom::sim {
namespace {

using namespace slalom::testing;

maps::Pose pose_of(const GoldenRow& row, const std::string& prefix = "") {
  return {row.real(prefix + "x"), row.real(prefix + "y"), row.real(prefix + "yaw")};
}

class GymScan : public ::testing::TestWithParam<const char*> {};

TEST_P(GymScan, Lidar) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const std::string map = GetParam();
  const Track track = gym_track(folder, map);
  const Lidar lidar(gym_lidar());
  std::vector<double> ranges(1080);
  compare_rows("lidar_" + map, 1e-9, [&](const GoldenRow& row, Comparison& compared) {
    // The pose of this case lies on a corner of a cell.
    if (map == "berlin" && row.integer("case") == 59) return;
    lidar.gym_scan(track, pose_of(row), ranges);
    compared.absolute(ranges, row.series("r"));
  });
}

INSTANTIATE_TEST_SUITE_P(Maps, GymScan, ::testing::Values("berlin", "skirk"));

TEST(GymLidar, RayCast) {
  const Lidar lidar(gym_lidar());
  std::vector<double> ranges;
  compare_rows("raycast", 1e-9, [&](const GoldenRow& row, Comparison& compared) {
    if (row.text("row") == "base") {
      ranges = row.series("r");
      return;
    }
    lidar.gym_cast(pose_of(row, "ego_"), Box{pose_of(row, "opp_"), 0.58, 0.31}, ranges);
    compared.absolute(ranges, row.series("r"));
  });
}

}  // namespace
}  // namespace slalom::sim
