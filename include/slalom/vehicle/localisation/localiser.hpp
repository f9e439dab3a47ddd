#pragma once

#include <memory>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/vehicle/localisation/localiser_options.hpp"

/// Where the car is on a known map, from LiDAR and odometry: Monte Carlo localisation.
///
///     Localiser localiser(course.map, {.seed = 1});
///     localiser.start_at(course.start);                 // or start_everywhere()
///     while (driving) {
///       const LocaliserOutput& seen = localiser.update({scan, odometry, stamp});
///       if (seen.status == LocaliserStatus::ok) use(seen.pose);
///     }
///
/// A pose is guessed by particles that move as the odometry says, with noise, and are drawn anew in
/// proportion to how well the scan fits the map from them: Thrun, Burgard & Fox, "Probabilistic Robotics"
/// (2005), Table 8.2. Their number follows the spread of the guess: D. Fox, "Adapting the Sample Size in
/// Particle Filters Through KLD-Sampling", IJRR 22(12), 2003, eq. 7. That the guess is wrong is told, as in
/// augmented MCL (Table 8.3), by a short-term average of the fit that falls below the long-term one; poses
/// from all of the free space then compete with it until the best place is clear.
///
/// Departures: the poses from elsewhere do not join the particles, where the first place that fits well would
/// drive out the right one, but are followed for themselves, and the particles are put to such a place once
/// it has fitted better for some time. The random numbers for drawing anew are a shifted radical inverse
/// sequence, so that every length of it is nearly stratified. The fit that is averaged is that of the
/// estimate by the likelihood field, the mean over beams, so that neither their number nor a parked car that
/// the map does not know gives an alarm; its long-term average counts as at least `least_fit`, so that a
/// global start is a search too. A rear axle in a wall counts as improbable.
namespace slalom::vehicle {

enum class LocaliserStatus {
  ok,
  uncertain,      ///< the particles are in several places, or the scan does not fit: do not drive fast by it
  bad_scan,       ///< empty, of the wrong form or with too few readings: moved by odometry alone
  bad_odometry,   ///< pose or stamp not finite: nothing was done
  odometry_jump,  ///< moved further than the car can: taken to have gone on as before, scan used
  stale,          ///< not later than the last update: nothing was done
};
constexpr const char* name(LocaliserStatus status) noexcept {
  switch (status) {
    case LocaliserStatus::ok:
      return "ok";
    case LocaliserStatus::uncertain:
      return "uncertain";
    case LocaliserStatus::bad_scan:
      return "bad_scan";
    case LocaliserStatus::bad_odometry:
      return "bad_odometry";
    case LocaliserStatus::odometry_jump:
      return "odometry_jump";
    case LocaliserStatus::stale:
      return "stale";
  }
  return "unknown";
}

struct LocaliserInput {
  maps::LaserScanView scan;
  maps::Pose odometry;  ///< of the rear axle when the scan was taken, in a frame of its own that may drift
  double stamp = 0;     ///< s, of the scan
};

/// A guess and what is known of its quality.
struct LocaliserOutput {
  LocaliserStatus status = LocaliserStatus::uncertain;
  maps::Pose pose;               ///< of the rear axle, map frame
  double covariance[3][3] = {};  ///< of x, y (m, map frame) and yaw (rad) of the particles near the estimate
  double fit = 0;                ///< share of beams that the map explains at the estimate, 0 .. 1
  double share = 0;              ///< of the weight near the estimate, 0 .. 1
  double health = 0;             ///< fit times share
  double effective_samples = 0;  ///< 1 / sum of squared weights, before drawing anew
  double update_time = 0;        ///< s of wall clock
  int particles = 0;             ///< that weighed this scan
  int beams = 0;                 ///< used of this scan
  bool resampled = false;        ///< particles were drawn anew after it
  bool searching = false;        ///< other places are being looked for
  bool relocated = false;        ///< the particles were put to another place, which fits better
};

/// A guessed pose (map frame) and its weight; the weights sum to 1.
struct Particle {
  maps::Pose pose;
  double weight = 0;
};

/// After construction nothing allocates or throws. The same seed and inputs give the same bits on one machine
/// and instruction set.
class Localiser {
 public:
  /// `map` is copied into the tables that are needed. Throws std::invalid_argument on options out of range
  /// and on a map without free or without occupied cells, with sizes that disagree or an origin or resolution
  /// that is not finite and positive. Starts everywhere.
  explicit Localiser(const maps::OccupancyGrid& map, const LocaliserOptions& options = {});
  ~Localiser();
  Localiser(Localiser&&) noexcept;
  Localiser& operator=(Localiser&&) noexcept;

  /// Puts all particles about a pose of the rear axle (map frame); false, with nothing done, if not finite.
  bool start_at(const maps::Pose& pose) noexcept;
  /// Spreads the particles over all of the free space.
  void start_everywhere() noexcept;
  /// Begins anew with another seed, everywhere.
  void reset(std::uint64_t seed) noexcept;

  const LocaliserOutput& update(const LocaliserInput& input) noexcept;
  const LocaliserOutput& output() const noexcept;

  /// The estimate carried on to a later odometry (same frame as the updates'): for a control loop that is
  /// faster than the scans.
  maps::Pose carried_to(const maps::Pose& odometry) const noexcept;
  /// The pose of the odometry's frame in the map frame, as a tf tree wants it.
  maps::Pose odometry_frame() const noexcept;

  int particle_count() const noexcept;
  Particle particle(int index) const noexcept;
  const LocaliserOptions& options() const noexcept;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace slalom::vehicle
