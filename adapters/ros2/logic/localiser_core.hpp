#pragma once

#include <array>
#include <cstdio>
#include <fstream>
#include <limits>
#include <optional>

#include "logic/input_watch.hpp"
#include "logic/installed.hpp"
#include "logic/named_option.hpp"
#include "logic/reports.hpp"
#include "logic/transforms.hpp"
#include "slalom/vehicle/localisation/localiser.hpp"

/// The last reliable pose of a localiser, from which one that is restarted continues.
namespace slalom::nodes {

/// Poses of the same point of the car at the same time: in the map frame, and in the odometry frame.
struct KnownPose {
  maps::Pose map, odometry;
};

/// The pose in the map frame, if the odometry is `odometry` now: `known`, moved as the odometry has moved
/// since. An odometry that starts again has its origin where the car is. So if it is nearer to its origin
/// than to that of `known`, the car is taken to be where it was.
inline maps::Pose pose_now(const KnownPose& known, const maps::Pose& odometry) {
  const double x = odometry.x - known.odometry.x, y = odometry.y - known.odometry.y;
  if (std::hypot(odometry.x, odometry.y) < std::hypot(x, y)) return known.map;
  const double turn = known.map.yaw - known.odometry.yaw;
  return composed({known.map.x, known.map.y, turn}, {x, y, odometry.yaw});
}

/// Writes a pose and the time (s since 1970) to a file, which has the old or the new content at any time.
/// Returns whether it could be written.
inline bool write_pose(const std::string& file, const KnownPose& pose, double time) {
  const std::string fresh = file + ".new";
  std::ofstream stream(fresh);
  stream.precision(std::numeric_limits<double>::max_digits10);
  const auto& [map, odometry] = pose;
  for (const double each : {map.x, map.y, map.yaw, odometry.x, odometry.y, odometry.yaw, time})
    stream << each << ' ';
  stream << '\n';
  stream.close();
  return stream && std::rename(fresh.c_str(), file.c_str()) == 0;
}

/// The pose in a file, unless a number is not finite or it was not written within the last 10 s.
inline std::optional<KnownPose> read_pose(const std::string& file, double time) {
  std::ifstream stream(file);
  std::array<double, 7> n{};
  for (double& each : n)
    if (!(stream >> each) || !std::isfinite(each)) return std::nullopt;
  constexpr double oldest = 10;  // s
  if (!(n[6] <= time && time - n[6] <= oldest)) return std::nullopt;
  return KnownPose{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

/// Whether the estimate of the pose can be used for driving. After it could not, it must be good for a
/// moment, since some scans fit a wrong pose by chance; a mediocre one, as beside a parked car, for longer.
class PoseTrust {
 public:
  /// After a doubt the estimate is trusted again after `scans` consecutive ones of at least this health.
  explicit PoseTrust(int scans = 10, double health = 0.7) : scans_(scans), health_(health) {}

  /// Takes the next estimate. Returns whether it can be used.
  bool update(const vehicle::LocaliserOutput& seen) {
    usable_ = seen.status == vehicle::LocaliserStatus::ok;
    if (!usable_) doubt_ = vehicle::name(seen.status);
    good_ = usable_ ? good_ + 1 : 0;
    fine_ = usable_ && seen.health >= health_ ? fine_ + 1 : 0;
    holds_ = usable_ && (holds_ || fine_ >= scans_ || good_ >= mediocre_scans * scans_);
    return holds_;
  }
  /// Whether the last estimate can be used.
  bool holds() const { return holds_; }
  /// The reason why it cannot be used.
  std::string doubt() const { return doubt_ + (usable_ ? ", over, until it is sure" : ""); }

 private:
  static constexpr int mediocre_scans = 6;  ///< this many times as many scans of any health are as good

  int scans_;
  double health_;
  int good_ = 0, fine_ = 0;
  bool holds_ = false, usable_ = false;
  std::string doubt_ = "uncertain";  ///< the last status that was not ok
};

/// A message of the odometry.
struct OdometrySample {
  Stamp stamp = 0;
  maps::Pose pose;                 ///< pose of the base frame in the odometry frame
  double speed = 0, yaw_rate = 0;  ///< m/s, rad/s
};

/// The logic of a localiser node, without the transport of its messages. While the estimate is not reliable
/// it publishes neither pose nor transform, and a planner stops. No function throws unless it says so. From a
/// scan to its estimate nothing is allocated in normal operation.
class LocaliserCore {
 public:
  /// The settings that are fixed when the node starts.
  struct Settings {
    std::string course{};     ///< a name or a folder, whose map is used; empty: the map is a message
    bool everywhere = false;  ///< search the whole map at the start
    std::optional<maps::Pose> start{};   ///< pose of the base frame; else the course's start, or everywhere
    std::optional<KnownPose> earlier{};  ///< last pose of the base frame by an earlier node; comes first
    int trust_scans = 10;                ///< see PoseTrust
    double trust_health = 0.7;           ///< see PoseTrust
    double transform_tolerance = 0.1;    ///< s, how far the stamps of transforms are in the future
    double rear_axle = 0;                ///< m, x of the middle of the rear axle in the base frame
    WatchLimits limits{};
  };
  /// The messages that the node sends; called from within the functions below.
  struct Outputs {
    /// A pose of the base frame in the map that can be relied on, with the covariance of `estimate`.
    std::function<void(const maps::Pose& base, const vehicle::LocaliserOutput& estimate, Stamp scan)> pose;
    /// The pose of the odometry frame in the map frame, with the stamp to publish it with.
    std::function<void(const maps::Pose& odometry_frame, Stamp stamp)> transform;
    std::function<void(const maps::OccupancyGrid&)> map;   ///< the map of the course, once
    std::function<void(const std::string&)> warn, inform;  ///< the log
  };

  /// Makes the localiser, without the map of the course yet.
  LocaliserCore(const Settings& settings, Clocks clocks, Transforms transforms, Outputs outputs);

  std::vector<NamedOption> options() const;
  /// Sets options; the localiser starts again from the last pose that was told or reliable. Throws
  /// std::exception with the rule; then nothing has changed.
  void change(const Changes& changes);

  /// Reads the map of the course, if there is one, once the options are set. Throws std::exception.
  void use_course();

  // Messages.
  void hear_map(const maps::OccupancyGrid& map);
  void hear_start(const maps::Pose& base);  ///< the pose of the base frame, from a user
  void hear_odometry(const OdometrySample& sample);
  void hear_scan(Stamp stamp, const std::string& frame, const maps::LaserScanView& scan, double angle_max);

  /// To be called every few milliseconds.
  void tick();

  /// Reports the events since the last report.
  Report report();
  /// The last pose of the base frame that could be relied on, as long as it can.
  std::optional<KnownPose> reliable() const;
  /// Poses of at most `most` particles.
  std::vector<maps::Pose> particles(int most) const;

 private:
  void use_map(const maps::OccupancyGrid& map);
  void begin();
  void continue_from(const KnownPose& earlier);
  void start_at(const std::optional<maps::Pose>& rear);
  bool odometry_at(Stamp stamp, maps::Pose& rear) const;
  void place_laser(const std::string& frame);
  /// The `i`-th odometry of those kept, the oldest first.
  const OdometrySample& odometry(std::size_t i) const { return odometry_[(oldest_ + i) % odometry_.size()]; }
  void localisation_warning(const std::string& text) { log_("localisation: " + text); }

  Clocks clocks_;
  Transforms transforms_;
  Outputs outputs_;
  Settings settings_;
  InputWatch watch_;
  ThrottledLog log_;
  vehicle::LocaliserOptions options_;
  maps::OccupancyGrid map_;
  std::optional<vehicle::Localiser> localiser_;  ///< none without a map
  std::optional<maps::Pose>
      start_;  ///< last pose of the rear axle that was told or reliable; none: everywhere
  PoseTrust trust_;
  std::array<OdometrySample, 50> odometry_;  ///< a ring
  std::size_t oldest_ = 0, count_ = 0;       ///< oldest entry and number of entries of `odometry_`
  Stamp last_scan_ = 0;
  std::optional<maps::Pose> course_start_;  ///< pose of the rear axle
  std::optional<KnownPose> known_;          ///< the last reliable pose of the rear axle
  vehicle::LocaliserOutput estimate_;
  double slowest_ = 0;  ///< s, since the last report
};

}  // namespace slalom::nodes
