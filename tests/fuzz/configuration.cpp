// Configuration files.
#include "slalom/vehicle/configuration/configuration.hpp"

#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"

namespace slalom::fuzz {
namespace {

std::vector<std::string> seeds() {
  return {vehicle::to_yaml({}),
          "base: other\nsvg_mppi:\n  samples: 4000\n  variance: [0.1]\nvehicle:\n  max_speed: 6\n  model: "
          "kinematic\n",
          "mppi: {temperature: 0.5, input_min: -.inf}\nplanner: {stop_when_blocked: true}\n"};
}

bool run(std::string_view bytes) {
  static const std::string other = scratch_file("other.yaml", "mppi:\n  samples: 100\n");
  try {
    const auto configuration =
        vehicle::load_configuration(scratch_file("configuration.yaml", bytes), {scratch_folder()});
    const std::string text = vehicle::to_yaml(configuration);
    require(vehicle::to_yaml(vehicle::load_configuration(scratch_file("again.yaml", text))) == text,
            "a configuration that is written reads back as the same");
    return true;
  } catch (const IoError&) {
    return false;
  }
}

const Target target("configuration", 8192, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
