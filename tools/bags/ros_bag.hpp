#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace slalom::tools {

/// A message as it was on the wire.
struct BagMessage {
  const std::string& topic;
  const std::string& type;  ///< package/Name
  std::string_view data;
};

/// Whether the name of a file is that of a ROS 1 bag.
bool is_bag(const std::string& file);

/// Hands over every message of a bag of ROS 1 (format 2.0, http://wiki.ros.org/Bags/Format/2.0), in the order
/// in which they were recorded. Needs no ROS. Throws IoError if the file is not a bag, is incomplete, damaged
/// or compressed.
void read_bag(const std::string& file, const std::function<void(const BagMessage&)>& take);

}  // namespace slalom::tools
