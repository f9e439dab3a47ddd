#pragma once

#include <cstring>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "dds/dds.h"
#include "wire.h"

/// A node that is compatible with ROS 2, over CycloneDDS: topics `rt/...`, types `pkg::msg::dds_::Type_`,
/// XCDR1, user data with the name of the enclave, and `ros_discovery_info`, from which `ros2 node list` knows
/// it.
namespace slalom_ros2 {

inline dds_entity_t checked(dds_entity_t entity, const std::string& what) {
  if (entity < 0) throw std::runtime_error(what + ": " + dds_strretcode(-entity));
  return entity;
}

enum class Quality {
  reliable,     ///< keep last 10
  sensor_data,  ///< best effort, keep last 5
  latched,      ///< reliable and transient local, keep last 1
};

/// Whose messages a reader receives.
enum class From { all_nodes, other_nodes };

class Qos {
 public:
  explicit Qos(Quality quality, From from = From::all_nodes) : qos_(dds_create_qos()) {
    const bool best_effort = quality == Quality::sensor_data;
    dds_qset_reliability(qos_, best_effort ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE,
                         DDS_MSECS(100));
    dds_qset_history(qos_, DDS_HISTORY_KEEP_LAST, quality == Quality::reliable ? 10 : best_effort ? 5 : 1);
    dds_qset_durability(
        qos_, quality == Quality::latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    const dds_data_representation_id_t representation = DDS_DATA_REPRESENTATION_XCDR1;
    dds_qset_data_representation(qos_, 1, &representation);
    if (from == From::other_nodes) dds_qset_ignorelocal(qos_, DDS_IGNORELOCAL_PARTICIPANT);
  }
  ~Qos() { dds_delete_qos(qos_); }
  Qos(const Qos&) = delete;
  Qos& operator=(const Qos&) = delete;
  operator dds_qos_t*() const { return qos_; }

 private:
  dds_qos_t* qos_;
};

/// A participant with the readers and writers of one node.
class Node {
 public:
  Node(const std::string& name, unsigned domain) : name_(name) {
    dds_qos_t* qos = dds_create_qos();
    dds_qset_userdata(qos, "enclave=/;", 10);
    participant_ = dds_create_participant(domain, qos, nullptr);
    dds_delete_qos(qos);
    checked(participant_, "participant");
    discovery_ = make_writer(&rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc, "ros_discovery_info",
                             Quality::latched);
  }
  ~Node() { dds_delete(participant_); }
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  /// `topic` is given without `rt/`.
  dds_entity_t writer(const dds_topic_descriptor_t* type, const std::string& topic, Quality quality) {
    writers_.push_back(make_writer(type, "rt/" + topic, quality));
    return writers_.back();
  }
  dds_entity_t reader(const dds_topic_descriptor_t* type, const std::string& topic, Quality quality,
                      From from = From::all_nodes) {
    const dds_entity_t made = make_topic(type, "rt/" + topic);
    readers_.push_back(
        checked(dds_create_reader(participant_, made, Qos(quality, from), nullptr), "reader of " + topic));
    return readers_.back();
  }

  /// Publishes the readers and writers of this node; to be called when all have been made.
  void announce() {
    using Gid = rmw_dds_common_msg_dds__Gid_;
    std::vector<Gid> readers, writers;
    for (const dds_entity_t reader : readers_) readers.push_back(gid(reader));
    for (const dds_entity_t writer : writers_) writers.push_back(gid(writer));
    rmw_dds_common_msg_dds__NodeEntitiesInfo_ node{};
    std::string space = "/";
    node.node_namespace = space.data();
    node.node_name = name_.data();
    node.reader_gid_seq._buffer = readers.data();
    node.reader_gid_seq._length = node.reader_gid_seq._maximum = static_cast<uint32_t>(readers.size());
    node.writer_gid_seq._buffer = writers.data();
    node.writer_gid_seq._length = node.writer_gid_seq._maximum = static_cast<uint32_t>(writers.size());
    rmw_dds_common_msg_dds__ParticipantEntitiesInfo_ info{};
    info.gid = gid(participant_);
    info.node_entities_info_seq._buffer = &node;
    info.node_entities_info_seq._length = info.node_entities_info_seq._maximum = 1;
    checked(dds_write(discovery_, &info), "ros_discovery_info");
  }

 private:
  dds_entity_t make_topic(const dds_topic_descriptor_t* type, const std::string& name) {
    dds_entity_t& topic = topics_[name];
    if (topic == 0)
      topic = checked(dds_create_topic(participant_, type, name.c_str(), nullptr, nullptr), "topic " + name);
    return topic;
  }
  dds_entity_t make_writer(const dds_topic_descriptor_t* type, const std::string& name, Quality quality) {
    return checked(dds_create_writer(participant_, make_topic(type, name), Qos(quality), nullptr),
                   "writer of " + name);
  }
  static rmw_dds_common_msg_dds__Gid_ gid(dds_entity_t entity) {
    dds_guid_t guid{};
    checked(dds_get_guid(entity, &guid), "guid");
    rmw_dds_common_msg_dds__Gid_ made{};
    std::memcpy(made.data, guid.v, sizeof guid.v);
    return made;
  }

  std::string name_;
  dds_entity_t participant_ = 0, discovery_ = 0;
  std::map<std::string, dds_entity_t> topics_;  ///< by name
  std::vector<dds_entity_t> readers_, writers_;
};

/// Calls `use` with every message received.
template <class Message, class Use>
void take_all(dds_entity_t reader, Use&& use) {
  void* samples[8] = {};
  dds_sample_info_t infos[8];
  for (;;) {
    const int count = dds_take(reader, samples, infos, 8, 8);
    if (count <= 0) return;
    for (int i = 0; i < count; ++i)
      if (infos[i].valid_data) use(*static_cast<const Message*>(samples[i]));
    dds_return_loan(reader, samples, count);
  }
}

}  // namespace slalom_ros2
