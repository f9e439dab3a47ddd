#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "bridge/bridge.hpp"
#include "bridge/frames.hpp"
#include "bridge/input_watch.hpp"
#include "bridge/report.hpp"
#include "bridge/throttled_log.hpp"

namespace slalom_bridge {

/// A sample of an inertial measurement unit, along the axes of its own frame.
struct ImuMessage {
  std::string frame;
  double turn[3] = {};          ///< rad/s, about x, y and z
  double acceleration[3] = {};  ///< m/s^2, along x, y and z
};

/// A planner node without the transport of its messages: a command for every scan. If an input is missing,
/// late, out of order, from the future or invalid, if the clock jumps or another node commands the car, it
/// sends speed 0 and logs the reason at most once per second. It continues by itself once the inputs have
/// been valid for a moment. No function throws unless it says so. From a scan to its command nothing is
/// allocated in normal operation.
class PlannerCore {
 public:
  struct Settings {
    std::string configuration = "default";  ///< a name or a file
    std::string method = "svg_mppi";
    std::string course;  ///< a name or a folder, whose path is driven; empty: the path comes as a message
    WatchLimits limits;
    double rear_axle = 0;      ///< m, x of the middle of the rear axle in the base frame
    double scan_interval = 0;  ///< s, scans that come sooner after the last one used are not used
  };
  /// What the node sends; called from within the functions below.
  struct Outputs {
    std::function<void(double steer, double speed)> drive;  ///< rad, m/s
    /// After every plan: the command and the stamp of its scan. `predicted` has its states.
    std::function<void(const Command&, Stamp)> plan;
    std::function<void(const std::vector<Waypoint>&, bool closed)> path;  ///< the path that is driven now
    std::function<void(const std::string&)> warn, inform;                 ///< the log
  };

  /// Without the path of a course yet. Throws std::exception with a message for the user.
  PlannerCore(const Settings& settings, Clocks clocks, Frames frames, Outputs outputs);

  std::vector<Option> options() const { return planner_.options(); }
  /// Throws std::exception with the rule; then nothing has changed.
  void change(const Changes& changes) { planner_.change(changes); }
  /// Throws std::exception.
  void save(const std::string& file) const { planner_.save(file); }

  /// Reads the path of the course, if there is one; to be called when the options are set. Throws
  /// std::exception.
  void use_course();

  // Messages.
  void hear_scan(Stamp stamp, const std::string& frame, const Scan& scan, double angle_max);
  void hear_odometry(Stamp stamp, double speed);  ///< m/s
  void hear_imu(const ImuMessage& sample);
  void hear_other_command(const std::string& name);  ///< a command that another node sent to the car
  void hear_goal_speed(double speed);                ///< m/s; 0 stops the car
  void hear_path(const std::vector<Waypoint>& path);

  /// Ends the drive after this many laps from here; 0: never. Throws std::exception where there is no closed
  /// path or the number is negative.
  void drive_laps(int laps);
  int laps() const { return laps_.laps(); }  ///< since the path was set or `drive_laps`

  /// To be called every few milliseconds.
  void tick();
  /// Sends speed 0 once and forgets all inputs.
  void halt();

  /// What happened since the last report.
  Report report();
  const std::vector<Pose>& predicted() const { return planner_.predicted(); }

 private:
  /// Statistics since the last report.
  struct Second {
    int plans = 0, stops = 0, late = 0, corrections = 0;
    double slowest = 0, min_samples = 1e300;
    std::string why;
  };

  bool scan_is_due() const;
  void start_anew();
  const Mount* imu_mount(const std::string& frame);
  void use_path(const std::vector<Waypoint>& path, bool closed);
  bool find_pose(Pose& pose);
  void place_laser();
  void plan();
  void stop(const std::string& why);
  void send(double steer, double speed);

  Clocks clocks_;
  Frames frames_;
  Outputs outputs_;
  Settings settings_;
  InputWatch watch_;
  ThrottledLog log_;
  Planner planner_;
  LapCount laps_;
  ImuSamples imu_;
  std::map<std::string, Mount> imu_mounts_;
  double imu_retry_ = -1e9;  ///< s, steady clock
  bool imu_warned_ = false;
  std::vector<float> ranges_;  ///< of the last scan, which `scan_` shows
  Scan scan_;
  std::string scan_frame_;
  Stamp scan_stamp_ = 0, used_ = 0, odometry_stamp_ = 0;  ///< `used_`: of the last scan with a plan
  double speed_ = 0;                                      ///< m/s
  bool new_scan_ = false, stopped_by_goal_ = false;
  int laps_to_drive_ = 0;
  double last_steer_ = 0;                   ///< rad
  double sent_ = -1e9, scan_heard_ = -1e9;  ///< s, steady clock
  Command known_;                           ///< of the last plan
  RecentValues latency_;                    ///< s, from the stamp of a scan to its command
  Second second_;
};

}  // namespace slalom_bridge
