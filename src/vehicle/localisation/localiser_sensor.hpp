#pragma once

#include "slalom/maps/cell_grid.hpp"
#include "slalom/maps/distance_field.hpp"
#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/vehicle/localisation/localiser_options.hpp"

namespace slalom::vehicle::detail {

constexpr int table_angles = 180;  ///< angles of the table of ranges

/// The beams of a scan that are used, in the frame of the rear axle, structure of arrays.
struct ScanBeams {
  explicit ScanBeams(int capacity)
      : end_x(static_cast<std::size_t>(capacity)),
        end_y(end_x),
        range(end_x),
        bin(end_x),
        forward_x(end_x),
        forward_y(end_x),
        sideways_x(end_x),
        sideways_y(end_x),
        steepest(end_x) {}

  std::vector<float> end_x, end_y;  ///< m
  std::vector<float> range;         ///< m; range_cap where nothing was hit
  std::vector<float> bin;           ///< bearing in angles of the range table, in [0, table_angles)
  // The change of the expected range when the laser moves by d (m, in this frame): -(forward . d), and
  // (sideways . d) times the difference (m) between two successive ranges of the table. A difference above
  // `steepest` is a corner and does not count.
  std::vector<float> forward_x, forward_y;    ///< the beam's direction
  std::vector<float> sideways_x, sideways_y;  ///< 1/m, across the beam
  std::vector<float> steepest;                ///< m
  int hits = 0;                               ///< number of beams with a return, which come first
  int count = 0;                              ///< number of all beams
};

/// Throws std::invalid_argument where a localiser cannot use the map (see Localiser).
void check_map(const maps::OccupancyGrid& map);

/// Chooses readings evenly over the scan: of every part of it the first usable one. False where the scan has
/// an invalid geometry or fewer than `min_beams` usable readings.
bool choose_beams(const maps::LaserScanView& scan, const LocaliserOptions& options,
                  ScanBeams& beams) noexcept;

/// Particles in the frame of the grid (m from the corner of cell (0, 0)), arrays padded to whole packs.
struct ParticlePoses {
  const float* x = nullptr;
  const float* y = nullptr;
  const float* yaw = nullptr;
  int count = 0;
};

/// Expected ranges from the centres of free cells in equal steps of angle; the distance from there to the
/// laser is corrected for a straight wall (dr = -d_forward + d_sideways r'(angle) / r). Without it, walls at
/// a small angle to the beam would appear half a metre off. A cell of the grid below holds the number of its
/// row of ranges; row 0 stands for "in a wall" and is all 0. An entry holds two successive ranges as 16-bit
/// parts of `range_unit`, so that one look-up serves an interpolation.
struct RangeTable {
  maps::CellGrid<1> rows{1, 1};
  maps::GridGeometry geometry;
  std::vector<std::uint32_t> pairs;  ///< rows x table_angles
  float range_unit = 0;              ///< m
};

/// The likelihood of a scan on the map.
class SensorTables {
 public:
  /// `map` has been checked. The model is the likelihood field where the table of ranges would be too large.
  SensorTables(const maps::OccupancyGrid& map, const LocaliserOptions& options);

  /// The model by which `weigh` computes.
  SensorModel model() const noexcept { return options_.sensor_model; }

  /// The mean over beams of the logarithm of each beam's probability over the highest possible one, for each
  /// particle; undefined for the padding. Needs beams.count >= 1, with the likelihood field hits >= 1.
  void weigh(const ParticlePoses& particles, const ScanBeams& beams, float* log_fit) const noexcept;

  /// The same as `weigh`, always by the likelihood field, which is smoother in the pose.
  void weigh_by_field(const ParticlePoses& particles, const ScanBeams& beams, float* log_fit) const noexcept;

  /// The quality of a pose, by the beams that came back.
  struct Explained {
    double share = 0;    ///< share of beams that end near a wall, 0 .. 1
    double counted = 0;  ///< the same of beams that do not end in front of a wall, at what is not in the map
    double fit = 0;      ///< mean over beams of each one's probability over the highest possible one, 0 .. 1
  };
  Explained explain(const maps::Pose& pose_grid, const ScanBeams& beams) const noexcept;

 private:
  void make_field(const maps::OccupancyGrid& map, const LocaliserOptions& options);
  void make_ranges(const maps::OccupancyGrid& map);

  LocaliserOptions options_;
  maps::GridGeometry geometry_;
  maps::CellGrid<1> field_;  ///< log of the probability of a beam's end over the highest one
  maps::CellGrid<1> place_;  ///< log of the probability of a rear axle there: 0 in free cells
  maps::DistanceField walls_;
  RangeTable table_;
  float explained_from_ = 0;  ///< least value of `field_` that explains a beam
};

/// Everything that a kernel reads.
struct WeighInput {
  ParticlePoses particles{};
  const ScanBeams* beams = nullptr;
  GridView<1> field{}, place{}, rows{};
  const std::uint32_t* pairs = nullptr;
  float range_unit = 0;
  float laser_x = 0, laser_y = 0;
  float hit_scale = 0;     ///< -1 / (2 sigma^2), 1/m^2
  float hit = 0;           ///< probability density at the expected range, over the highest one
  float random = 0;        ///< density of a range from anywhere, over the highest one
  float short_scale = 0;   ///< density of a range from something in front, at 0 m
  float short_rate = 0;    ///< 1/m
  float lost = 0;          ///< that a beam does not come back though it should, over that it rightly does not
  float nothing_from = 0;  ///< m, expected ranges from which on nothing is hit
  float* log_fit = nullptr;
};

void weigh_by_field(const WeighInput& input) noexcept;
void weigh_by_ranges(const WeighInput& input) noexcept;

}  // namespace slalom::vehicle::detail
