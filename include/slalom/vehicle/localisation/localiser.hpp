#pragma once

#include <memory>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/vehicle/localisation/localiser_options.hpp"

/// The pose of the car on a known map, from LiDAR and odometry: Monte Carlo localisation.
///
///     Localiser localiser(course.map, {.seed = 1});
///     localiser.start_at(course.start);                 // or start_everywhere()
///     while (driving) {
///       const LocaliserOutput& seen = localiser.update({scan, odometry, stamp});
///       if (seen.status == LocaliserStatus::ok) use(seen.pose);
///     }
///
/// Particles move with the odometry and its noise, and are resampled in proportion to the likelihood of the
/// scan at their poses (Thrun, Burgard & Fox, "Probabilistic Robotics" (2005), Table 8.2). Their number
/// adapts to their spread (D. Fox, "Adapting the Sample Size in Particle Filters Through KLD-Sampling", IJRR
/// 22(12), 2003, eq. 7). A wrong estimate is detected as in augmented MCL (Table 8.3), by a short-term
/// average of the fit below the long-term one.
///
/// Departures: hypotheses from all of the free space do not join the particles, where the first one that fits
/// well would displace the right one. They are tracked separately, and the particles move to one that has
/// fitted clearly better for some time. Resampling is nearly stratified. The averaged fit is that of the
/// estimate by the likelihood field, the mean over beams. A start everywhere begins with a search; until it
/// is over, the estimate is uncertain. A rear axle in a wall counts as improbable.
namespace slalom::vehicle {

/// The reliability of the estimate.
enum class LocaliserStatus {
  ok,
  uncertain,      ///< the particles are in several places, or the scan does not fit: do not rely on it
  bad_scan,       ///< empty, of invalid geometry or with too few readings: moved by odometry alone
  bad_odometry,   ///< pose or stamp not finite, or larger than `LocaliserInput` allows: ignored
  odometry_jump,  ///< moved further than the car can: the last motion is continued, the scan is used
  /// less than 1 s before the last update, or of the same time: ignored. A stamp that is earlier still means
  /// that the clock was set back, and is used
  stale,
};
/// The name of a status, as results have it.
constexpr const char* name(LocaliserStatus status) noexcept {
  constexpr const char* names[] = {"ok", "uncertain", "bad_scan", "bad_odometry", "odometry_jump", "stale"};
  return names[static_cast<int>(status)];
}

/// The input of an update.
struct LocaliserInput {
  static constexpr double furthest = 1e7;  ///< m, largest magnitude of a coordinate
  static constexpr double max_yaw = 1e6;   ///< rad, largest magnitude of a yaw
  static constexpr double latest = 1e12;   ///< s, largest magnitude of a stamp

  maps::LaserScanView scan;  ///< the scan, in the frame of the laser
  maps::Pose odometry;       ///< pose of the rear axle at the time of the scan, in a frame that may drift
  double stamp = 0;          ///< s, of the scan
};

/// The estimate and its quality.
struct LocaliserOutput {
  LocaliserStatus status = LocaliserStatus::uncertain;  ///< how reliable the estimate is
  maps::Pose pose;                                      ///< pose of the rear axle, map frame
  double covariance[3][3] = {};  ///< covariance of x, y (m, map frame), yaw (rad) near the estimate
  double fit = 0;                ///< share of beams that the map explains at the estimate, 0 .. 1
  double share = 0;              ///< share of the weight near the estimate, 0 .. 1
  double health = 0;             ///< fit times share
  double effective_samples = 0;  ///< 1 / sum of squared weights, before resampling
  double update_time = 0;        ///< s of wall clock
  int particles = 0;             ///< particles that weighed this scan
  int beams = 0;                 ///< used of this scan
  bool searching = false;        ///< hypotheses in other places are tracked
};

/// A particle; the weights of all sum to 1.
struct Particle {
  maps::Pose pose;    ///< pose of the rear axle, map frame
  double weight = 0;  ///< 0 .. 1
};

/// Monte Carlo localisation. After construction nothing allocates or throws. The same seed and inputs give
/// the same bits on one machine and instruction set.
class Localiser {
 public:
  /// Copies the needed parts of `map` into tables, and starts everywhere. Throws std::invalid_argument on
  /// options out of range, and on a map without free or without occupied cells, with more than 32766 cells to
  /// a side, sizes that disagree, an origin that is not finite or a resolution not finite and above 0.
  explicit Localiser(const maps::OccupancyGrid& map, const LocaliserOptions& options = {});
  ~Localiser();
  /// Copies everything: the copy continues bit for bit like the original. The tables of the map are shared.
  Localiser(const Localiser& other);
  Localiser& operator=(const Localiser& other);
  Localiser(Localiser&&) noexcept;
  Localiser& operator=(Localiser&&) noexcept;

  /// Draws all particles around a pose of the rear axle (map frame); false, without effect, if it is not
  /// finite or larger than `LocaliserInput` allows.
  bool start_at(const maps::Pose& pose) noexcept;
  /// Draws the particles from all of the free space. The estimate is uncertain for at least `search_time`.
  void start_everywhere() noexcept;
  /// Starts everywhere, with another seed.
  void reset(std::uint64_t seed) noexcept;

  /// Updates the estimate with a scan and the odometry at its time.
  const LocaliserOutput& update(const LocaliserInput& input) noexcept;
  const LocaliserOutput& output() const noexcept;  ///< output of the last update

  /// The pose of the odometry's frame in the map frame, as in a tf tree.
  maps::Pose odometry_frame() const noexcept;

  int particle_count() const noexcept;          ///< number of the present particles
  Particle particle(int index) const noexcept;  ///< 0 <= index < particle_count()
  /// The options given at construction, but for `sensor_model`: likelihood_field where the table of ranges
  /// would have more than 2^27 entries, 180 for each free cell of 0.1 m (or of the map, if larger).
  const LocaliserOptions& options() const noexcept;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace slalom::vehicle
