#pragma once

#include <functional>
#include <optional>
#include <string>

#include "bridge/bridge.hpp"
#include "bridge/input_watch.hpp"
#include "bridge/pose_trust.hpp"
#include "bridge/throttled_log.hpp"

namespace slalom_ros2 {

using slalom_bridge::Pose;

/// Localisation and planner of a car, without the transport of the messages. If an input is missing, late,
/// out of order, from the future or invalid, if the clock jumps or another node commands the car, it sends
/// speed 0 and logs the reason at most once per second. It continues by itself once the inputs have been
/// valid for a moment.
class Driver {
 public:
  struct Settings {
    std::string course = "wren";            ///< a name or a folder
    std::string configuration = "default";  ///< a name or a file
    std::string method = "svg_mppi";
    bool map_from_topic = false;  ///< wait for `hear_map`; otherwise the map is that of the course
    slalom_bridge::Changes set;   ///< options of the planner
  };
  /// What the node sends; called from within the functions below.
  struct Outputs {
    std::function<void(double steer, double speed)> drive;  ///< rad, m/s
    std::function<void(const Pose& odometry_frame)>
        transform;  ///< in the map frame, at the stamp of the scan
    std::function<void(const std::string& line)> log;
  };

  /// Throws std::exception with a message for the user.
  Driver(const Settings& settings, slalom_bridge::Clocks clocks, Outputs outputs);

  // Messages. Stamps are in seconds of the clock of the stamps.
  void hear_map(const slalom_bridge::Grid& map);
  void hear_odometry(double stamp, const Pose& pose, double speed);                 ///< of the rear axle; m/s
  void hear_imu(double yaw_rate, double forward, double leftward);                  ///< rad/s, m/s^2
  void hear_scan(double stamp, const slalom_bridge::Scan& scan, double angle_max);  ///< rad, of the last beam
  void hear_other_command();  ///< a command that another node sent to the car

  /// To be called every few milliseconds.
  void tick();

 private:
  void use_map(const slalom_bridge::Grid& map);
  Pose whereabouts() const;
  void start_anew();
  bool localise(const slalom_bridge::Scan& scan, double stamp);
  void report(const slalom_bridge::Command& command);
  void send(double steer, double speed);
  void stop();

  slalom_bridge::Clocks clocks_;
  Outputs outputs_;
  slalom_bridge::InputWatch watch_;
  slalom_bridge::ThrottledLog log_;
  slalom_bridge::Planner planner_;
  slalom_bridge::Localiser localiser_;
  slalom_bridge::PoseTrust trust_;
  slalom_bridge::ImuSamples imu_;
  Pose start_;                 ///< of the course
  std::optional<Pose> known_;  ///< the last pose that the car drove by, map frame
  Pose known_odometry_;        ///< the odometry of then
  Pose pose_, odometry_;
  double speed_ = 0, steer_ = 0;              ///< m/s, rad
  double last_scan_ = 0, last_odometry_ = 0;  ///< s, stamps; 0: none yet
  double sent_ = -1e9, reported_ = -1e9;      ///< s, steady clock
};

}  // namespace slalom_ros2
