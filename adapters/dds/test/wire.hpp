#pragma once

#include <chrono>
#include <cmath>
#include <string>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include "messagesPubSubTypes.h"

/// The wire protocol of ROS 2 by another implementation than that of the node, Fast DDS.
namespace slalom_ros2_test {

using namespace eprosima::fastdds::dds;

inline double now() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

inline builtin_interfaces::msg::Time time_message(double t) {
  builtin_interfaces::msg::Time m;
  m.sec(static_cast<std::int32_t>(std::floor(t)));
  m.nanosec(static_cast<std::uint32_t>((t - std::floor(t)) * 1e9));
  return m;
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
    return participant_->create_topic(name, type.get_type_name(), TOPIC_QOS_DEFAULT);
  }

  DomainParticipant* participant_ = nullptr;
  Publisher* publisher_ = nullptr;
  Subscriber* subscriber_ = nullptr;
};

inline std_msgs::msg::Header header(double t, const char* frame) {
  std_msgs::msg::Header h;
  h.stamp(time_message(t));
  h.frame_id(frame);
  return h;
}

inline geometry_msgs::msg::Quaternion quaternion(double yaw) {
  geometry_msgs::msg::Quaternion q;
  q.x(0);
  q.y(0);
  q.z(std::sin(yaw / 2));
  q.w(std::cos(yaw / 2));
  return q;
}

}  // namespace slalom_ros2_test
