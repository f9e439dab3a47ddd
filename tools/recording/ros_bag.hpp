#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "slalom/vehicle/model/identification.hpp"

namespace slalom::tools {

/// The messages of ROS 2 from which a drive is known: poses, measured speeds and steering commands. Reads the
/// types nav_msgs/msg/Odometry, geometry_msgs/msg/PoseStamped, geometry_msgs/msg/PoseWithCovarianceStamped
/// and ackermann_msgs/msg/AckermannDriveStamped, in CDR of little-endian machines.
class RosDrive {
 public:
  /// Adds a message; one of another type is ignored. `time`: ns, when it was received; the stamp of its
  /// header is used where it has one. Throws std::invalid_argument if the message ends too soon.
  void add(std::string_view topic, std::string_view type, std::uint64_t time, std::string_view message);

  /// Returns a sample for each pose, in the order of time, from the first pose on. A sample has the speed
  /// measured at this time and the first command that followed, else the last one before it; what is missing
  /// is NaN. `topics` receives a sentence on the topics that were chosen:
  /// - poses in the frame `map`, of `pf/pose/odom` if there are any, else of the topic with most of them;
  /// - speeds of the odometry in another frame with most messages, else of the poses' topic;
  /// - commands of `ackermann_cmd`, else of `drive`, else of the topic with most of them.
  /// Throws std::invalid_argument that names the topics found if there are no poses, speeds or commands.
  std::vector<vehicle::DrivenSample> samples(std::string& topics) const;

 private:
  struct Pose {
    double time, x, y, yaw;
  };
  struct Value {
    double time, value;
  };
  template <class T>
  using Topics = std::map<std::string, std::vector<T>>;

  std::string all_topics() const;

  Topics<Pose> poses_;
  Topics<Value> speeds_;         ///< speeds of odometry in other frames than `map`
  Topics<Value> commands_;       ///< steering angles, rad
  Topics<Value> mapped_speeds_;  ///< speeds of odometry in the frame `map`
};

/// Adds the messages of a rosbag2 file in sqlite3. Throws IoError if it cannot be read.
void read_sqlite_bag(const std::string& file, RosDrive& drive);

}  // namespace slalom::tools
