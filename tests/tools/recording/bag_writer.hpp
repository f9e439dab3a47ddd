#pragma once

#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <string>

namespace slalom::testing {

/// Fields as ROS 1 serialises them.
class Wire {
 public:
  template <class T>
  Wire& put(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Wire& text(const std::string& value) {
    put(static_cast<std::uint32_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  Wire& zeros(int count) {
    bytes_.append(static_cast<std::size_t>(count), '\0');
    return *this;
  }
  Wire& header(double stamp, const std::string& frame) {
    const auto seconds = static_cast<std::uint32_t>(stamp);
    put(std::uint32_t{0}).put(seconds).put(static_cast<std::uint32_t>(std::round(1e9 * (stamp - seconds))));
    return text(frame);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Writes a bag of ROS 1, format 2.0, all in one chunk and without indexes.
class BagWriter {
 public:
  void add(const std::string& topic, const std::string& type, const Wire& message) {
    const auto [found, added] = numbers_.try_emplace(topic, static_cast<std::uint32_t>(numbers_.size()));
    const std::string conn = Wire().put(found->second).bytes();
    if (added)
      record({{"op", "\x07"}, {"conn", conn}, {"topic", topic}}, fields({{"topic", topic}, {"type", type}}));
    record({{"op", "\x02"}, {"conn", conn}, {"time", std::string(8, '\0')}}, message.bytes());
  }

  std::string bytes(const std::string& compression = "none") {
    const std::string inside = std::move(records_);
    records_ = "#ROSBAG V2.0\n";
    record({{"op", "\x03"}, {"index_pos", std::string(8, '\0')}}, std::string(100, ' '));
    record({{"op", "\x05"},
            {"compression", compression},
            {"size", Wire().put(static_cast<std::uint32_t>(inside.size())).bytes()}},
           inside);
    return records_;
  }

 private:
  using Fields = std::map<std::string, std::string>;
  static std::string fields(const Fields& values) {
    Wire wire;
    for (const auto& [name, value] : values) wire.text(name + "=" + value);
    return wire.bytes();
  }
  void record(const Fields& header, const std::string& data) {
    records_ += Wire().text(fields(header)).text(data).bytes();
  }

  std::string records_;
  std::map<std::string, std::uint32_t> numbers_;
};

}  // namespace slalom::testing
