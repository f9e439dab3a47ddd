// A car on another implementation of the protocol, Fast DDS: the simulator publishes scans, odometry,
// transforms and a map as ROS 2 does, and follows `drive`. Succeeds if the laps are driven without a
// collision, and missing scans and scans from the future stop the car, which then continues.
//
//   slalom_ros2_peer COURSE LAPS OBSTACLES DOMAIN
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <thread>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include "bridge/bridge.hpp"
#include "messagesPubSubTypes.h"

namespace {

using namespace eprosima::fastdds::dds;
using slalom_bridge::Pose;

double now() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

enum class Quality { reliable, sensor_data, latched };

template <class Qos>
void set(Qos& qos, Quality quality) {
  qos.reliability().kind =
      quality == Quality::sensor_data ? BEST_EFFORT_RELIABILITY_QOS : RELIABLE_RELIABILITY_QOS;
  qos.durability().kind =
      quality == Quality::latched ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
  qos.history().kind = KEEP_LAST_HISTORY_QOS;
  qos.history().depth = quality == Quality::reliable ? 10 : quality == Quality::sensor_data ? 5 : 1;
}

class Peer {
 public:
  explicit Peer(int domain) {
    DomainParticipantQos qos;
    const std::string enclave = "enclave=/;";
    qos.user_data().setValue({enclave.begin(), enclave.end()});
    participant_ =
        DomainParticipantFactory::get_instance()->create_participant(static_cast<std::uint32_t>(domain), qos);
    publisher_ = participant_->create_publisher(PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  }
  ~Peer() {
    participant_->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  template <class Type>
  DataWriter* writer(const std::string& topic, Quality quality) {
    DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
    set(qos, quality);
    return publisher_->create_datawriter(make_topic<Type>(topic), qos);
  }
  template <class Type>
  DataReader* reader(const std::string& topic, Quality quality) {
    DataReaderQos qos = DATAREADER_QOS_DEFAULT;
    set(qos, quality);
    return subscriber_->create_datareader(make_topic<Type>(topic), qos);
  }

 private:
  template <class Type>
  Topic* make_topic(const std::string& name) {
    if (auto* made = dynamic_cast<Topic*>(participant_->lookup_topicdescription(name))) return made;
    TypeSupport type(new Type);
    type.register_type(participant_);
    std::printf("%s: %s\n", name.c_str(), type.get_type_name().c_str());
    return participant_->create_topic(name, type.get_type_name(), TOPIC_QOS_DEFAULT);
  }

  DomainParticipant* participant_ = nullptr;
  Publisher* publisher_ = nullptr;
  Subscriber* subscriber_ = nullptr;
};

std_msgs::msg::Header header(double t, const char* frame) {
  std_msgs::msg::Header h;
  h.stamp().sec(static_cast<std::int32_t>(std::floor(t)));
  h.stamp().nanosec(static_cast<std::uint32_t>((t - std::floor(t)) * 1e9));
  h.frame_id(frame);
  return h;
}

geometry_msgs::msg::Quaternion quaternion(double yaw) {
  geometry_msgs::msg::Quaternion q;
  q.x(0);
  q.y(0);
  q.z(std::sin(yaw / 2));
  q.w(std::cos(yaw / 2));
  return q;
}

/// The simulated car and the messages that it has received.
class Car {
 public:
  Car(const std::string& course, int obstacles, int domain)
      : peer_(domain),
        world_(course, 1, obstacles),
        scan_(peer_.writer<sensor_msgs::msg::LaserScanPubSubType>("rt/scan", Quality::sensor_data)),
        odometry_(peer_.writer<nav_msgs::msg::OdometryPubSubType>("rt/odom", Quality::reliable)),
        tf_(peer_.writer<tf2_msgs::msg::TFMessagePubSubType>("rt/tf", Quality::reliable)),
        map_(peer_.writer<nav_msgs::msg::OccupancyGridPubSubType>("rt/map", Quality::latched)),
        drive_(peer_.reader<ackermann_msgs::msg::AckermannDriveStampedPubSubType>("rt/drive",
                                                                                  Quality::reliable)),
        tf_in_(peer_.reader<tf2_msgs::msg::TFMessagePubSubType>("rt/tf", Quality::reliable)),
        nodes_(peer_.reader<rmw_dds_common::msg::ParticipantEntitiesInfoPubSubType>("ros_discovery_info",
                                                                                    Quality::latched)) {
    send_map(course);
  }

  enum class Fault { none, silent, future };
  Fault fault = Fault::none;

  /// One step of 25 ms that begins at `t` (s).
  void step(double t) {
    hear();
    const bool commanded = now() - heard_ < 0.2;
    world_.step(steer_, commanded ? speed_ : 0);
    send(t);
  }

  double speed() const { return speed_; }
  int laps() const { return world_.reading().laps; }
  int contacts() const { return world_.reading().contacts; }
  long commands() const { return commands_; }
  bool knows_node() const { return knows_node_; }
  bool heard_transform() const { return heard_transform_; }

 private:
  void hear() {
    SampleInfo info;
    ackermann_msgs::msg::AckermannDriveStamped drive;
    while (drive_->take_next_sample(&drive, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data || !std::isfinite(drive.drive().speed())) continue;
      steer_ = static_cast<double>(drive.drive().steering_angle());
      speed_ = static_cast<double>(drive.drive().speed());
      heard_ = now();
      ++commands_;
    }
    tf2_msgs::msg::TFMessage tf;
    while (tf_in_->take_next_sample(&tf, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data)
        for (const auto& t : tf.transforms()) heard_transform_ |= t.header().frame_id() == "map";
    rmw_dds_common::msg::ParticipantEntitiesInfo nodes;
    while (nodes_->take_next_sample(&nodes, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data)
        for (const auto& n : nodes.node_entities_info_seq())
          knows_node_ |= n.node_name() == "slalom_driver" && n.writer_gid_seq().size() == 2;
  }

  void send(double t) {
    const auto& seen = world_.reading();
    nav_msgs::msg::Odometry odometry;
    odometry.header(header(t, "odom"));
    odometry.child_frame_id("base_link");
    odometry.pose().pose().position().x(seen.odometry.x);
    odometry.pose().pose().position().y(seen.odometry.y);
    odometry.pose().pose().orientation(quaternion(seen.odometry.yaw));
    odometry.twist().twist().linear().x(seen.speed);
    odometry.twist().twist().angular().z(seen.yaw_rate);
    odometry_->write(&odometry);
    geometry_msgs::msg::TransformStamped transform;
    transform.header(header(t, "odom"));
    transform.child_frame_id("base_link");
    transform.transform().translation().x(seen.odometry.x);
    transform.transform().translation().y(seen.odometry.y);
    transform.transform().rotation(quaternion(seen.odometry.yaw));
    tf2_msgs::msg::TFMessage tf;
    tf.transforms().push_back(transform);
    tf_->write(&tf);
    if (fault == Fault::silent) return;
    sensor_msgs::msg::LaserScan scan;
    scan.header(header(fault == Fault::future ? t + 5 : t, "laser"));
    scan.angle_min(static_cast<float>(seen.angle_min));
    scan.angle_increment(static_cast<float>(seen.angle_increment));
    scan.angle_max(static_cast<float>(seen.angle_min +
                                      seen.angle_increment * (static_cast<double>(seen.ranges.size()) - 1)));
    scan.range_min(0.02F);
    scan.range_max(static_cast<float>(seen.range_max));
    scan.ranges(seen.ranges);
    scan_->write(&scan);
  }

  void send_map(const std::string& course) {
    const auto grid = slalom_bridge::load_course(course).map;
    nav_msgs::msg::OccupancyGrid m;
    m.header(header(now(), "map"));
    m.info().resolution(static_cast<float>(grid.resolution));
    m.info().width(static_cast<std::uint32_t>(grid.width));
    m.info().height(static_cast<std::uint32_t>(grid.height));
    m.info().origin().position().x(grid.origin.x);
    m.info().origin().position().y(grid.origin.y);
    m.info().origin().orientation(quaternion(grid.origin.yaw));
    m.data().assign(grid.cells.begin(), grid.cells.end());
    map_->write(&m);
  }

  Peer peer_;
  slalom_bridge::World world_;
  DataWriter *scan_, *odometry_, *tf_, *map_;
  DataReader *drive_, *tf_in_, *nodes_;
  double steer_ = 0, speed_ = 0, heard_ = 0;
  long commands_ = 0;
  bool knows_node_ = false, heard_transform_ = false;
};

/// Runs the world until `holds` has been true for `lasting` (s). Returns false if that takes longer than
/// `most` (s).
template <class Holds>
bool run_until(Car& car, double& due, const char* what, Holds&& holds, double lasting, double most) {
  const double begin = now();
  double since = now();
  while (now() - begin < most) {
    std::this_thread::sleep_for(std::chrono::duration<double>(std::max(0.0, due - now())));
    car.step(due);
    due += 0.025;
    if (!holds()) {
      since = now();
      continue;
    }
    if (now() - since < lasting) continue;
    std::printf("ok: %s (%.1f s)\n", what, now() - begin);
    std::fflush(stdout);
    return true;
  }
  std::printf("FAILED: %s: timed out after %.0f s\n", what, most);
  return false;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 5) throw std::invalid_argument("usage: slalom_ros2_peer COURSE LAPS OBSTACLES DOMAIN");
  const int laps = std::stoi(argv[2]);
  Car car(argv[1], std::stoi(argv[3]), std::stoi(argv[4]));
  double due = now();
  const auto drives = [&] { return car.speed() > 0.3; };
  const auto stands = [&] { return car.speed() == 0; };
  bool well = run_until(car, due, "commanded to drive", drives, 0.3, 30);
  for (const Car::Fault fault : {Car::Fault::silent, Car::Fault::future}) {
    well = well && run_until(car, due, "drives", drives, 1, 20);
    car.fault = fault;
    well = well &&
           run_until(car, due,
                     fault == Car::Fault::silent ? "scans silent: stops" : "scans from the future: stops",
                     stands, 0.5, 3);
    car.fault = Car::Fault::none;
    well = well && run_until(car, due, "drives on", drives, 0.3, 20);
  }
  const int before = car.laps();
  well = well && run_until(
                     car, due, "laps", [&] { return car.laps() >= before + laps; }, 0, 60.0 * laps);
  std::printf("%d laps, %d contacts, %ld commands; node announced: %s; transform from map heard: %s\n",
              car.laps(), car.contacts(), car.commands(), car.knows_node() ? "yes" : "no",
              car.heard_transform() ? "yes" : "no");
  return well && car.contacts() == 0 && car.knows_node() && car.heard_transform() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "slalom_ros2_peer: %s\n", error.what());
  return 1;
}
