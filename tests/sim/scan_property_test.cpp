#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "sim/lidar/scan.hpp"
#include "sim/rooms.hpp"
#include "slalom/sim/lidar.hpp"
#include "slalom/sim/shapes.hpp"

namespace slalom::sim {
namespace {

maps::OccupancyGrid scattered(std::uint32_t seed) {
  maps::OccupancyGrid grid = testing::room(180, 140);
  std::mt19937 random(seed);
  for (int i = 0; i < 60; ++i) {
    const int x = static_cast<int>(random() % 170), y = static_cast<int>(random() % 130);
    for (int dx = 0; dx < 5; ++dx)
      for (int dy = 0; dy < 3; ++dy) grid.at(x + dx, y + dy) = maps::Occupancy::occupied;
  }
  grid.origin = {-2, 3, 0.3};
  return grid;
}

/// The way to the first wall cell by small steps: never beyond the true one by more than a step.
double walk(const Track& track, const maps::Pose& sensor, double angle, double most) {
  const double step = 0.0005, c = std::cos(sensor.yaw + angle), s = std::sin(sensor.yaw + angle);
  double t = 0;
  while (t < most && !track.in_wall({sensor.x + t * c, sensor.y + t * s})) t += step;
  return std::min(t, most);
}

TEST(ScanProperty, RangesAreTheWaysToTheFirstWallCell) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const Track track(scattered(seed));
    LidarOptions options{.beams = 333, .field_of_view = 6.28, .range_max = 6};
    const Lidar lidar(options);
    std::vector<float> ranges(lidar.padded_beams());
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> along(0, 1);
    for (int n = 0; n < 12; ++n) {
      const maps::Point at = maps::transform(track.grid().origin, {9 * along(random), 7 * along(random)});
      const maps::Pose sensor{at.x, at.y, 6 * along(random)};
      lidar.scan(track, sensor, ranges);
      int off = 0;
      for (std::size_t i = 0; i < lidar.angles().size(); ++i) {
        const double truth = walk(track, sensor, lidar.angles()[i], options.range_max);
        const double error = ranges[i] - truth;
        // A step of the walk may pass over a corner that a beam touches by less; hence a few beams may be
        // nearer, but none may pass a wall.
        ASSERT_LE(error, 1e-3) << "beam " << i;
        if (error < -1e-3) ++off;
      }
      EXPECT_LE(off, 3);
    }
  }
}

TEST(ScanProperty, EveryInstructionSetGivesTheSameBits) {
  const Track track(scattered(7));
  for (const int beams : {1, 2, 15, 16, 17, 64, 65, 271, 1080, 1100, 3000}) {
    LidarOptions options{.beams = beams};
    const Lidar lidar(options);
    std::vector<float> cosines(lidar.padded_beams()), sines(cosines), cone_cosines(256), cone_sines(256);
    for (std::size_t i = 0; i < cosines.size(); ++i) {
      const double angle = lidar.angles()[std::min(i, lidar.angles().size() - 1)];
      cosines[i] = static_cast<float>(std::cos(angle));
      sines[i] = static_cast<float>(std::sin(angle));
    }
    for (std::size_t i = 0; i < cone_cosines.size(); ++i) {
      const double angle = options.angle_min() + (i * 16 + 7.5) * options.angle_increment();
      cone_cosines[i] = static_cast<float>(std::cos(angle));
      cone_sines[i] = static_cast<float>(std::sin(angle));
    }
    std::vector<float> first;
    for (const simd::Target target :
         {simd::Target::avx512, simd::Target::avx2, simd::Target::sse4, simd::Target::generic}) {
      if (!simd::supported(target)) continue;
      const detail::ScanKernels kernels = detail::scan_kernels(target);
      std::vector<float> ranges(lidar.padded_beams());
      kernels.walls({.clearance = track.clearance().data(),
                     .stride = track.clearance_stride(),
                     .x = 90.3f,
                     .y = 70.7f,
                     .cosine = std::cos(0.4f),
                     .sine = std::sin(0.4f),
                     .cosines = cosines.data(),
                     .sines = sines.data(),
                     .beams = beams,
                     .cone_cosines = cone_cosines.data(),
                     .cone_sines = cone_sines.data(),
                     .cone_width = static_cast<float>(7.5 * options.angle_increment() + 1e-5),
                     .most = 600,
                     .beyond = 1e-3f,
                     .resolution = 0.05f,
                     .range_max = 30,
                     .ranges = ranges.data()});
      kernels.cast({.x = -2,
                    .y = 0.3f,
                    .cosine = std::cos(0.2f),
                    .sine = std::sin(0.2f),
                    .cosines = cosines.data(),
                    .sines = sines.data(),
                    .half_length = 0.29f,
                    .half_width = 0.155f,
                    .radius = 0,
                    .first = beams / 4,
                    .last = beams - 1,
                    .ranges = ranges.data()});
      kernels.noise({.key0 = 1,
                     .key1 = 2,
                     .deviation = 0.01f,
                     .most = 30,
                     .lost_below = 1u << 28,
                     .count = beams,
                     .ranges = ranges.data()});
      ranges.resize(beams);
      if (first.empty()) first = ranges;
      EXPECT_EQ(std::memcmp(first.data(), ranges.data(), ranges.size() * sizeof(float)), 0)
          << simd::name(target) << " with " << beams << " beams";
    }
  }
}

TEST(ScanProperty, TheGymWindowReachesToTheNearestBeamOfEveryCorner) {
  LidarOptions options{.gym = true};
  const Lidar lidar(options);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-3, 3);
  for (int n = 0; n < 500; ++n) {
    const maps::Pose sensor{any(random), any(random), 3 * any(random)};
    const Box box{{any(random), any(random), any(random)}, 0.58, 0.31};
    int first = options.beams - 1, last = 0;
    const double heading = std::atan2(std::sin(sensor.yaw), std::cos(sensor.yaw));
    for (const maps::Point& corner : corners(box)) {
      const double dx = corner.x - sensor.x, dy = corner.y - sensor.y, d = std::sqrt(dx * dx + dy * dy);
      double angle = heading - std::atan2(dy / d, dx / d);
      if (angle > M_PI) angle -= 2 * M_PI;
      if (angle < -M_PI) angle += 2 * M_PI;
      int nearest = 0;
      for (int i = 1; i < options.beams; ++i)
        if (std::abs(lidar.angles()[i] + angle) < std::abs(lidar.angles()[nearest] + angle)) nearest = i;
      first = std::min(first, nearest);
      last = std::max(last, nearest);
    }
    std::vector<double> seen(lidar.angles().size(), 30.0), expected(seen);
    lidar.gym_cast(sensor, box, seen);
    for (int i = first; i <= last; ++i) {
      const double angle = sensor.yaw + lidar.angles()[i];
      double& range = expected[i];
      range = std::min(range, ray_distance({sensor.x, sensor.y}, std::cos(angle), std::sin(angle), box));
    }
    ASSERT_EQ(seen, expected);
  }
}

TEST(ScanProperty, OpenBorderReturnsNothing) {
  maps::OccupancyGrid grid = testing::room(100, 100);
  std::fill(grid.cells.begin(), grid.cells.end(), maps::Occupancy::free);
  const Lidar lidar(LidarOptions{});
  std::vector<float> ranges(lidar.padded_beams());
  lidar.scan(Track(grid, {}, false), {2, 2, 1}, ranges);
  EXPECT_TRUE(std::all_of(ranges.begin(), ranges.begin() + 1080, [](float r) { return r == 30.0f; }));
  lidar.scan(Track(grid), {2, 2, 0}, ranges);
  EXPECT_NEAR(ranges[540], 3, 0.01);
  lidar.scan(Track(grid), {-1, 2, 0}, ranges);
  EXPECT_EQ(ranges[540], 0);
}

TEST(RangeNoise, IsNormalIndependentAndRepeats) {
  NormalNoise a, b, again;
  a.reset(5, 0);
  b.reset(5, 1);
  again.reset(5, 0);
  const int count = 1080, scans = 400;
  double sum = 0, squares = 0, fourths = 0, product = 0, lagged = 0;
  for (int n = 0; n < scans; ++n) {
    std::vector<float> x(1088, 50.0f), y(x), z(x);
    a.add(x, count, 1, 100, 0);
    b.add(y, count, 1, 100, 0);
    again.add(z, count, 1, 100, 0);
    ASSERT_EQ(x, z);
    for (std::size_t i = 0; i < count; ++i) {
      const double u = x[i] - 50.0, v = y[i] - 50.0;
      sum += u;
      squares += u * u;
      fourths += u * u * u * u;
      product += u * v;
      if (i > 0) lagged += u * (x[i - 1] - 50.0);
    }
  }
  const double total = count * scans, deviation = 1 / std::sqrt(total);
  EXPECT_NEAR(sum / total, 0, 5 * deviation);
  EXPECT_NEAR(squares / total, 1, 5 * std::sqrt(2.0) * deviation);
  EXPECT_NEAR(fourths / total, 3, 5 * std::sqrt(96.0) * deviation);
  EXPECT_NEAR(product / total, 0, 5 * deviation);
  EXPECT_NEAR(lagged / total, 0, 5 * deviation);
}

TEST(RangeNoise, DropsTheGivenShareAndKeepsLimits) {
  NormalNoise noise;
  noise.reset(1, 0);
  int lost = 0;
  for (int n = 0; n < 100; ++n) {
    std::vector<float> ranges(1088, 0.005f);
    ranges[7] = 30;
    noise.add(ranges, 1080, 0.01, 30, 0.1);
    EXPECT_EQ(ranges[7], 30);
    for (std::size_t i = 0; i < 1080; ++i) {
      ASSERT_GE(ranges[i], 0);
      lost += ranges[i] == 30;
    }
  }
  EXPECT_NEAR(lost, 100 + 0.1 * 1079 * 100, 5 * std::sqrt(0.09 * 107900));
}

}  // namespace
}  // namespace slalom::sim
