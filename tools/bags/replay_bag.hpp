#pragma once

#include <string>

#include "tools/scenario/scenario.hpp"

namespace slalom::tools {

struct BagReplay {
  std::string file;          ///< a bag of ROS 1
  std::string record;        ///< the recording made of it: MCAP, or JSON lines
  ScenarioArguments driver;  ///< configuration and options; a course only if it is not the bag's own
  std::string method = "svg_mppi";
};

/// Feeds the scans of a bag to a planner and records its plans as if it drove:
/// the car moves as in the bag, regardless of the planner's commands. Prints how these differ
/// from those in the bag. Throws IoError, std::invalid_argument.
void record_bag(const BagReplay& replay);

}  // namespace slalom::tools
