#pragma once

#include <map>

#include "logic/car_page.hpp"
#include "logic/input_watch.hpp"
#include "logic/installed.hpp"
#include "logic/named_option.hpp"
#include "logic/others_watch.hpp"
#include "logic/reports.hpp"
#include "logic/transforms.hpp"
#include "slalom/maps/command.hpp"
#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/sim/laps.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::nodes {

/// A sample of an inertial measurement unit, along the axes of its own frame.
struct ImuMessage {
  std::string frame;
  double turn[3] = {};          ///< rad/s, about x, y and z
  double acceleration[3] = {};  ///< m/s^2, along x, y and z
};

/// Whether an update of the planner found a plan; otherwise the car brakes.
inline bool has_plan(vehicle::PlannerStatus status) {
  using vehicle::PlannerStatus;
  return status == PlannerStatus::ok || status == PlannerStatus::fallback_plan ||
         status == PlannerStatus::solver_degenerate;
}

/// The logic of a planner node, without the transport of its messages: a command for every scan. If an input
/// is missing, late, out of order, from the future or invalid, if the clock jumps or another node commands
/// the car, it sends speed 0 and logs the reason at most once per second. It continues by itself once the
/// inputs have been valid for a moment. No function throws unless it says so. From a scan to its command
/// nothing is allocated in normal operation.
class PlannerCore {
 public:
  using Path = std::vector<maps::ReferencePoint>;

  /// The settings that are fixed when the node starts.
  struct Settings {
    std::string configuration = "default";  ///< a name or a file
    std::string method = "svg_mppi";
    std::string course{};  ///< a name or a folder, whose path is driven; empty: the path comes as a message
    WatchLimits limits{};
    std::string others = "none";  ///< where it learns of other cars: a name of OthersFrom
    double rear_axle = 0;         ///< m, x of the middle of the rear axle in the base frame
    int view_port = 0;            ///< port of the live view; 0: none
    double scan_interval = 0;     ///< s, scans that come sooner after the last one used are not used
  };
  /// The messages that the node sends; called from within the functions below.
  struct Outputs {
    std::function<void(const Command&)> drive;                            ///< the command for the car
    std::function<void(const vehicle::PlannerOutput&, Stamp scan)> plan;  ///< after every plan
    std::function<void(const Path&, bool closed)> path;                   ///< the path that is driven now
    std::function<void(const std::string&)> warn, inform;                 ///< the log
  };

  /// Makes the planner, without the path of the course yet. Throws std::exception.
  PlannerCore(const Settings& settings, Clocks clocks, Transforms transforms, Outputs outputs);

  /// The options of vehicle, planner and method.
  std::vector<NamedOption> options() const;
  /// Sets options; the planner starts anew. Throws std::exception with the rule; then nothing has changed.
  void change(const Changes& changes);
  /// Writes all options as a configuration file; an old file is replaced. Throws std::exception.
  void save(const std::string& file) const;

  /// Reads the path of the course, if there is one, once the options are set. Throws std::exception.
  void use_course();

  // Messages.
  void hear_scan(Stamp stamp, const std::string& frame, const maps::LaserScanView& scan, double angle_max);
  void hear_odometry(Stamp stamp, double speed);     ///< m/s
  void hear_other_command(const std::string& name);  ///< a command that another node sent to the car
  void hear_path(const Path& path);
  // Messages that a car need not send.
  void hear_imu(const ImuMessage& sample);
  void hear_goal_speed(double speed);  ///< m/s; 0 stops the car
  /// The covariance (x, y, yaw) of the pose in tf.
  void hear_covariance(Stamp stamp, const vehicle::PoseCovariance& covariance);
  void hear_executed(const Command& command);  ///< the car executes this, where others may command it
  /// Points of obstacles (m) in a sensor's frame; heights do not count. Once heard they must stay recent.
  void hear_points(Stamp stamp, const std::string& frame, std::span<const std::array<double, 3>> points);
  /// The objects that another node tracks, map frame; needed with `others` = "topic".
  void hear_objects(Stamp stamp, std::span<const tracking::TrackedObject> objects);

  /// Ends the drive after this many laps; 0: never. Throws std::exception without a closed path or below 0.
  void drive_laps(int laps);
  int laps() const;  ///< whole laps since the path was set or `drive_laps`

  /// To be called every few milliseconds.
  void tick();
  /// Sends speed 0 once and forgets all inputs.
  void halt();

  /// Reports the events since the last report.
  Report report();

 private:
  /// Laps along a closed path, from the first pose on. Driving backwards counts down.
  struct Laps {
    sim::LapPath path;
    sim::LapTimer timer;
    bool started = false;
  };
  /// Statistics since the last report.
  struct Second {
    int plans = 0, stops = 0, late = 0, corrections = 0;
    double slowest = 0, min_samples = 1e300;
    std::string why;
  };

  vehicle::Planner make_planner(const vehicle::Configuration& with, const Path& along) const;
  bool scan_is_due() const;
  void start_anew();
  const Mount* imu_mount(const std::string& frame);
  std::optional<Command> obeyed() const;
  bool has_fresh_inputs();
  void complete(vehicle::PlannerInput& input);
  void forget_inputs();
  void use_path(const Path& path, bool closed);
  bool find_pose(maps::Pose& pose);
  void place_laser();
  void plan();
  void stop(const std::string& why);
  void show(const vehicle::PlannerInput& input, const vehicle::PlannerOutput& out);
  void count_laps(const maps::Pose& pose);
  void send(const Command& command);

  Clocks clocks_;
  Transforms transforms_;
  Outputs outputs_;
  Settings settings_;
  InputWatch watch_;
  ThrottledLog log_;
  vehicle::Configuration configuration_;
  Path path_;
  std::optional<vehicle::Planner> planner_;  ///< none without a path
  std::optional<CarPage> page_;              ///< none without `view_port`, and before the first plan
  std::optional<Laps> laps_;                 ///< none without a closed path
  ImuReading imu_sum_;                       ///< sum of the samples since the last plan
  int imu_count_ = 0;                        ///< number of these samples
  std::map<std::string, Mount> imu_mounts_;
  double imu_retry_ = -1e9;  ///< s, steady clock
  bool imu_warned_ = false;
  std::optional<double> goal_speed_;  ///< m/s
  vehicle::PoseCovariance covariance_{};
  std::array<Command, 16> sent_lately_{};  ///< the latest commands
  std::size_t next_sent_ = 0, others_ = 0;
  Command executed_;
  double executed_heard_ = -1e9;                                    ///< s, steady clock
  std::vector<maps::Point> heard_points_, points_, points_of_car_;  ///< m, base, map and robot frame
  OthersFrom others_from_;
  std::optional<OthersWatch> others_watch_;  ///< none without a path or others
  std::optional<maps::OccupancyGrid> map_;   ///< map of the course, if there is one
  std::vector<float> ranges_;                ///< the last scan, which `scan_` shows
  maps::LaserScanView scan_;
  std::string scan_frame_;
  Stamp scan_stamp_ = 0, odometry_stamp_ = 0, covariance_stamp_ = 0, heard_points_stamp_ = 0,
        points_stamp_ = 0, objects_stamp_ = 0;
  Stamp used_ = 0;    ///< stamp of the last scan with a plan
  double speed_ = 0;  ///< m/s
  bool new_scan_ = false;
  int laps_to_drive_ = 0;
  double last_steer_ = 0;                   ///< rad
  double sent_ = -1e9, scan_heard_ = -1e9;  ///< s, steady clock
  vehicle::ParameterEstimate known_;        ///< estimates of car and ground, from the last plan
  double slip_ = 0;                         ///< rad, the same
  std::string last_stop_;                   ///< the reason for the last stop, and when (s, clock of stamps)
  RecentValues latency_;                    ///< s, from the stamp of a scan to its command
  Second second_;
};

}  // namespace slalom::nodes
