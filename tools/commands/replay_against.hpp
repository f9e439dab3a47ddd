#pragma once

#include "tools/scenario/scenario.hpp"

namespace slalom::tools {

/// A recorded drive, and the planner that is compared with its driver.
struct AgainstArguments {
  std::string recording;
  ScenarioArguments scenario;  ///< course, configuration, options, and where an unlocalised drive began
  std::string method = "svg_mppi";
  std::string json, plot;
};

/// Shows what the planner would have done at each moment of a recorded drive: it gets the recorded poses,
/// speeds and scans, and the car obeys the recorded commands. Prints how its commands differ, and the moments
/// where they differ most. Returns the exit status. Throws IoError, CommandLineError.
int replay_against(const AgainstArguments& arguments);

}  // namespace slalom::tools
