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

/// Puts what the car saw, scan by scan, before a planner, and records what it makes of that as if it drove:
/// the car goes where it went in the bag, whatever the planner says. Prints how the planner's commands differ
/// from those in the bag. Throws IoError, std::invalid_argument.
void record_bag(const BagReplay& replay);

}  // namespace slalom::tools
