#include "tools/recording/ros_bag.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <memory>

#include "slalom/core/error.hpp"

namespace slalom::tools {
namespace {

constexpr double most_gap = 0.2;  // s between measured speeds that are interpolated
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Reads a message in CDR (OMG Common Data Representation): four bytes that tell the byte order, then values,
/// each aligned to its size.
class CdrReader {
 public:
  explicit CdrReader(std::string_view message) {
    if (message.size() < 4 || message[0] != 0 || message[1] != 1)
      throw std::invalid_argument("must be in CDR of a little-endian machine");
    body_ = message.substr(4);
  }

  template <class T>
  T get() {
    at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    T value{};
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::string_view text() {
    const std::string_view text = take(get<std::uint32_t>());
    return text.substr(0, text.find('\0'));
  }
  std::vector<float> floats() {
    const std::size_t count = get<std::uint32_t>();
    const std::string_view bytes = take(count * sizeof(float));
    std::vector<float> values(count);
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
  void skip_doubles(std::size_t count) {
    get<double>();
    take((count - 1) * sizeof(double));
  }

 private:
  std::string_view take(std::size_t bytes) {
    if (at_ > body_.size() || bytes > body_.size() - at_) throw std::invalid_argument("it ends too soon");
    at_ += bytes;
    return body_.substr(at_ - bytes, bytes);
  }

  std::string_view body_;
  std::size_t at_ = 0;
};

/// The header of a message.
struct Header {
  double time = 0;  ///< s
  std::string_view frame;

  Header(CdrReader& from, std::uint64_t received) {
    const auto seconds = from.get<std::int32_t>();
    const auto nanoseconds = from.get<std::uint32_t>();
    frame = from.text();
    time = seconds == 0 && nanoseconds == 0 ? 1e-9 * static_cast<double>(received)
                                            : seconds + 1e-9 * nanoseconds;
    if (frame.starts_with('/')) frame.remove_prefix(1);
  }
};

RecordedScan read_scan(CdrReader& from, double time) {
  RecordedScan scan{.time = time};
  scan.shape.angle_min = from.get<float>();
  from.get<float>();  // angle_max
  scan.shape.angle_increment = from.get<float>();
  from.get<float>();  // time_increment
  from.get<float>();  // scan_time
  scan.shape.range_min = from.get<float>();
  scan.shape.range_max = from.get<float>();
  scan.ranges = from.floats();
  return scan;
}

/// The messages of one topic by time. One with the time of another is left out.
template <class T>
std::vector<T> in_order(std::vector<T> values) {
  std::stable_sort(values.begin(), values.end(), [](const T& a, const T& b) { return a.time < b.time; });
  values.erase(
      std::unique(values.begin(), values.end(), [](const T& a, const T& b) { return a.time == b.time; }),
      values.end());
  return values;
}

/// The topic to use: the first whose name ends in one of `preferred`, else that of most messages, else null.
template <class Topics>
const typename Topics::value_type* chosen(const Topics& topics,
                                          std::initializer_list<std::string_view> preferred) {
  for (const std::string_view name : preferred)
    for (const auto& topic : topics)
      if (topic.first == name || topic.first.ends_with("/" + std::string(name))) return &topic;
  const auto most = std::max_element(topics.begin(), topics.end(), [](const auto& a, const auto& b) {
    return a.second.size() < b.second.size();
  });
  return most == topics.end() ? nullptr : &*most;
}

/// The position of the first value that is not before `time`.
template <class T>
std::size_t first_from(const std::vector<T>& values, double time) {
  const auto found = std::lower_bound(values.begin(), values.end(), time,
                                      [](const T& each, double at) { return each.time < at; });
  return static_cast<std::size_t>(found - values.begin());
}

}  // namespace

void RosDrive::add(std::string_view topic, std::string_view type, std::uint64_t time,
                   std::string_view message) {
  const bool odometry = type == "nav_msgs/msg/Odometry",
             command = type == "ackermann_msgs/msg/AckermannDriveStamped",
             scan = wanted_ == Wanted::scans && type == "sensor_msgs/msg/LaserScan";
  if (!odometry && !command && !scan && type != "geometry_msgs/msg/PoseStamped" &&
      type != "geometry_msgs/msg/PoseWithCovarianceStamped")
    return;
  CdrReader reader(message);
  const Header header(reader, time);
  const std::string name(topic);
  if (command) {
    const double steer = reader.get<float>();
    reader.get<float>();  // the rate of the steering
    commands_[name].push_back({header.time, steer, reader.get<float>()});
    return;
  }
  if (scan) {
    scans_[name].push_back(read_scan(reader, header.time));
    return;
  }
  if (odometry) reader.text();  // the frame of the body
  const bool in_map = header.frame == "map";
  const auto x = reader.get<double>(), y = reader.get<double>();
  reader.skip_doubles(1);
  const auto qx = reader.get<double>(), qy = reader.get<double>(), qz = reader.get<double>(),
             qw = reader.get<double>();
  if (in_map || odometry)
    (in_map ? poses_ : odometry_)[name].push_back(
        {header.time, x, y, std::atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))});
  if (!odometry) return;
  reader.skip_doubles(36);  // the covariance of the pose
  (in_map ? mapped_speeds_ : speeds_)[name].push_back({header.time, reader.get<double>()});
}

std::string RosDrive::all_topics() const {
  std::string names;
  const auto list = [&](const auto& topics, const char* what) {
    for (const auto& [name, messages] : topics)
      names += (names.empty() ? "" : ", ") + name + " (" + what + ")";
  };
  list(poses_, "poses in the frame map");
  list(speeds_, "odometry in another frame");
  list(commands_, "steering commands");
  list(scans_, "scans");
  return names.empty() ? "none of the types that are read" : names;
}

DrivenRecording RosDrive::drive() const {
  DrivenRecording drive;
  const auto* poses = chosen(poses_, {"pf/pose/odom"});
  if (!poses && wanted_ == Wanted::scans) {
    poses = chosen(odometry_, {});
    drive.in_map = false;
  }
  const auto* speeds = chosen(speeds_, {});
  const auto* const commands = chosen(commands_, {"ackermann_cmd", "drive"});
  const auto* const scans = chosen(scans_, {"scan"});
  if (poses && !speeds)
    if (const auto found = mapped_speeds_.find(poses->first); found != mapped_speeds_.end()) speeds = &*found;
  const char* missing = nullptr;
  if (!poses)
    missing = wanted_ == Wanted::scans ? "poses (nav_msgs/Odometry)"
                                       : "poses in the frame map (nav_msgs/Odometry, PoseStamped or "
                                         "PoseWithCovarianceStamped, as localisers publish them)";
  else if (!speeds)
    missing = "measured speed (nav_msgs/Odometry)";
  else if (!commands)
    missing = "steering commands (ackermann_msgs/AckermannDriveStamped)";
  else if (!scans && wanted_ == Wanted::scans)
    missing = "scans (sensor_msgs/LaserScan)";
  if (missing)
    throw std::invalid_argument(std::string("the bag has no ") + missing + "; its topics: " + all_topics());
  drive.topics =
      "poses of " + poses->first + ", speeds of " + speeds->first + ", commands of " + commands->first;
  const auto at = in_order(poses->second);
  const auto measured = in_order(speeds->second);
  const auto sent = in_order(commands->second);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Pose& pose = at[i];
    const std::size_t after = first_from(measured, pose.time), next = first_from(sent, pose.time);
    double speed = unknown;
    if (after < measured.size() && measured[after].time == pose.time) {
      speed = measured[after].value;
    } else if (after > 0 && after < measured.size()) {
      const Speed &before = measured[after - 1], &then = measured[after];
      const double share = (pose.time - before.time) / (then.time - before.time);
      if (then.time - before.time <= most_gap) speed = before.value + share * (then.value - before.value);
    }
    const bool follows = next < sent.size() && (i + 1 == at.size() || sent[next].time < at[i + 1].time);
    Command command{0, unknown, unknown};
    if (follows || next > 0) command = sent[follows ? next : next - 1];
    drive.samples.push_back(
        {pose.time - at.front().time, pose.x, pose.y, pose.yaw, speed, command.steer, command.speed});
  }
  if (!scans) return drive;
  drive.topics += ", scans of " + scans->first;
  drive.scans = in_order(scans->second);
  for (RecordedScan& scan : drive.scans) scan.time -= at.front().time;
  return drive;
}

void read_sqlite_bag(const std::string& file, RosDrive& drive) {
  sqlite3* opened = nullptr;
  const int failed = sqlite3_open_v2(file.c_str(), &opened, SQLITE_OPEN_READONLY, nullptr);
  const std::unique_ptr<sqlite3, int (*)(sqlite3*)> database(opened, sqlite3_close);
  const auto check = [&](bool good) {
    if (!good) throw IoError(file, 0, std::string("is not a bag of rosbag2: ") + sqlite3_errmsg(opened));
  };
  check(failed == SQLITE_OK);
  sqlite3_stmt* prepared = nullptr;
  check(sqlite3_prepare_v2(
            opened,
            "SELECT topics.name, topics.type, messages.timestamp, messages.data FROM messages "
            "JOIN topics ON topics.id = messages.topic_id WHERE topics.serialization_format = 'cdr'",
            -1, &prepared, nullptr) == SQLITE_OK);
  const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> rows(prepared, sqlite3_finalize);
  const auto text = [&](int column) {
    const void* const bytes = sqlite3_column_blob(prepared, column);
    return std::string_view(bytes ? static_cast<const char*>(bytes) : "",
                            static_cast<std::size_t>(sqlite3_column_bytes(prepared, column)));
  };
  int state = SQLITE_ROW;
  while ((state = sqlite3_step(prepared)) == SQLITE_ROW) try {
      drive.add(text(0), text(1), static_cast<std::uint64_t>(sqlite3_column_int64(prepared, 2)), text(3));
    } catch (const std::invalid_argument& error) {
      throw IoError(file, 0,
                    "has a message that cannot be read: " + std::string(text(0)) + ": " + error.what());
    }
  check(state == SQLITE_DONE);
}

}  // namespace slalom::tools
