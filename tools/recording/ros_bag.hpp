#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/vehicle/model/identification.hpp"

namespace slalom::tools {

/// A scan of a recording.
struct RecordedScan {
  double time = 0;              ///< s, on the clock of the samples
  maps::LaserScanView shape{};  ///< all but the ranges
  std::vector<float> ranges{};  ///< m

  maps::LaserScanView view() const {
    maps::LaserScanView scan = shape;
    scan.ranges = ranges;
    return scan;
  }
};

/// A drive as it was recorded, in the order of time.
struct DrivenRecording {
  std::vector<vehicle::DrivenSample> samples;  ///< the first is at time 0 in a bag
  std::vector<RecordedScan> scans;             ///< empty unless they are wanted
  bool in_map = true;                          ///< poses are in the frame of the map, not of odometry
  std::string topics;                          ///< sentence on the topics that were chosen, of a bag
};

/// The parts of a drive that are read.
enum class Wanted {
  samples,  ///< samples with poses in the frame of the map
  scans,    ///< also the scans; poses of odometry, where no others are recorded
};

/// The messages of ROS 2 from which a drive is known: poses, measured speeds, commands and scans. Reads the
/// types nav_msgs/msg/Odometry, geometry_msgs/msg/PoseStamped, geometry_msgs/msg/PoseWithCovarianceStamped,
/// ackermann_msgs/msg/AckermannDriveStamped and sensor_msgs/msg/LaserScan, in CDR of little-endian machines.
class RosDrive {
 public:
  explicit RosDrive(Wanted wanted = Wanted::samples) : wanted_(wanted) {}

  /// Adds a message; one of another type is ignored. `time`: ns, when it was received; the stamp of its
  /// header is used where it has one. Throws std::invalid_argument if the message ends too soon.
  void add(std::string_view topic, std::string_view type, std::uint64_t time, std::string_view message);

  /// Returns a sample for each pose, in the order of time, from the first pose on. A sample has the speed
  /// measured at this time and the first command that followed, else the last one before it; what is missing
  /// is NaN. The topics are these:
  /// - poses in the frame `map`, of `pf/pose/odom` if there are any, else of the topic with most of them;
  /// - speeds of the odometry in another frame with most messages, else of the poses' topic;
  /// - commands of `ackermann_cmd`, else of `drive`, else of the topic with most of them;
  /// - scans of `scan`, else of the topic with most of them.
  /// Throws std::invalid_argument that names the topics found if what is wanted is missing.
  DrivenRecording drive() const;

 private:
  struct Pose {
    double time, x, y, yaw;
  };
  struct Speed {
    double time, value;
  };
  struct Command {
    double time, steer, speed;
  };
  template <class T>
  using Topics = std::map<std::string, std::vector<T>>;

  std::string all_topics() const;

  Wanted wanted_;
  Topics<Pose> poses_, odometry_;         ///< poses in the frame `map`; of odometry in other frames
  Topics<Speed> mapped_speeds_, speeds_;  ///< speeds of odometry in the frame `map`; in other frames
  Topics<Command> commands_;
  Topics<RecordedScan> scans_;
};

/// Adds the messages of a rosbag2 file in sqlite3. Throws IoError if it cannot be read.
void read_sqlite_bag(const std::string& file, RosDrive& drive);

}  // namespace slalom::tools
