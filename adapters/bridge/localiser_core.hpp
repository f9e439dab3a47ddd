#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bridge/bridge.hpp"
#include "bridge/frames.hpp"
#include "bridge/input_watch.hpp"
#include "bridge/known_place.hpp"
#include "bridge/pose_trust.hpp"
#include "bridge/report.hpp"
#include "bridge/throttled_log.hpp"

namespace slalom_bridge {

/// What an odometry says: the pose of the base frame in the odometry frame.
struct OdometrySample {
  Stamp stamp = 0;
  Pose pose;
  double speed = 0, yaw_rate = 0;  ///< m/s, rad/s
};

/// A localiser node without the transport of its messages. While the estimate is not reliable it publishes
/// neither pose nor transform, and a planner stops. No function throws unless it says so. From a scan to its
/// estimate nothing is allocated in normal operation.
class LocaliserCore {
 public:
  struct Settings {
    std::string course;         ///< a name or a folder, whose map is used; empty: the map is a message
    bool everywhere = false;    ///< search the whole map at the start
    std::optional<Pose> start;  ///< of the base frame; otherwise the start of the course, or everywhere
    std::optional<KnownPlace> earlier;  ///< where an earlier node knew the base frame to be; comes first
    int trust_scans = 10;               ///< see PoseTrust
    double trust_health = 0.7;          ///< likewise
    double transform_tolerance = 0.1;   ///< s, how far the stamps of transforms are in the future
    double rear_axle = 0;               ///< m, x of the middle of the rear axle in the base frame
    WatchLimits limits;
  };
  /// What the node sends; called from within the functions below.
  struct Outputs {
    /// A pose that can be relied on: that of the base frame in the map at the stamp of a scan, with the
    /// covariance of `estimate`.
    std::function<void(const Pose& base, const Estimate& estimate, Stamp scan)> pose;
    /// The pose of the odometry frame in the map frame, with the stamp to publish it with.
    std::function<void(const Pose& odometry_frame, Stamp stamp)> transform;
    std::function<void(const Grid&)> map;                  ///< that of the course, once
    std::function<void(const std::string&)> warn, inform;  ///< the log
  };

  /// Without the map of a course yet.
  LocaliserCore(const Settings& settings, Clocks clocks, Frames frames, Outputs outputs);

  std::vector<Option> options() const { return localiser_.options(); }
  /// Throws std::exception with the rule; then nothing has changed.
  void change(const Changes& changes) { localiser_.change(changes); }

  /// Reads the map of the course, if there is one; to be called when the options are set. Throws
  /// std::exception.
  void use_course();

  // Messages.
  void hear_map(const Grid& map);
  void hear_start(const Pose& base);  ///< the pose of the base frame, from a user
  void hear_odometry(const OdometrySample& sample);
  void hear_scan(Stamp stamp, const std::string& frame, const Scan& scan, double angle_max);

  /// To be called every few milliseconds.
  void tick();

  /// What happened since the last report.
  Report report();
  /// The last place of the base frame that could be relied on, as long as it can.
  std::optional<KnownPlace> reliable() const;
  /// Poses of at most `most` particles.
  std::vector<Pose> particles(int most) const { return localiser_.particles(most); }

 private:
  void use_map(const Grid& map);
  void begin();
  void continue_from(const KnownPlace& earlier);
  bool odometry_at(Stamp stamp, Pose& rear) const;
  void place_laser(const std::string& frame);
  /// The `i`-th odometry of those kept, the oldest first.
  const OdometrySample& odometry(std::size_t i) const { return odometry_[(oldest_ + i) % odometry_.size()]; }
  void localisation_warning(const std::string& text) { log_("localisation: " + text); }

  Clocks clocks_;
  Frames frames_;
  Outputs outputs_;
  Settings settings_;
  InputWatch watch_;
  ThrottledLog log_;
  Localiser localiser_;
  PoseTrust trust_;
  std::array<OdometrySample, 50> odometry_;  ///< a ring
  std::size_t oldest_ = 0, count_ = 0;       ///< of `odometry_`
  Stamp last_scan_ = 0;
  std::optional<Pose> course_start_;  ///< of the rear axle
  std::optional<KnownPlace> known_;   ///< likewise
  Estimate estimate_;
  double slowest_ = 0;  ///< s, since the last report
};

}  // namespace slalom_bridge
