#pragma once

#include <memory>

#include "slalom/evaluation/lap.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "view/protocol/messages.hpp"

namespace slalom::view {

/// A scenario, loaded.
struct LoadedScenario {
  std::shared_ptr<const evaluation::Environment> environment;
  vehicle::Configuration configuration;
  evaluation::LapSettings lap;
};

/// A lap of an evaluation, loaded.
struct LoadedLap {
  ScenarioNames names;
  LoadedScenario scenario;
};

}  // namespace slalom::view
