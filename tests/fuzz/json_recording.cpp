// Recordings in JSON lines, and the identification of a car from them.
#include <cmath>

#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"
#include "src/evaluation/json.hpp"
#include "support/identification_promise.hpp"
#include "tools/recording/driven_samples.hpp"

namespace slalom::fuzz {
namespace {

/// A drive in curves, of a car that does what it is told.
std::string drive(int ticks) {
  std::string text = R"({"type":"recording","version":1})"
                     "\n";
  double x = 0, y = 0, yaw = 0;
  for (int i = 0; i < ticks; ++i) {
    const double time = 0.05 * i, steer = 0.3 * std::sin(2 * time);
    text += Json{{"type", "tick"},
                 {"time", time},
                 {"odometry", Json::array({x, y, yaw, 2.0})},
                 {"command", Json::array({steer, 2.0})}}
                .dump() +
            "\n";
    x += 0.1 * std::cos(yaw);
    y += 0.1 * std::sin(yaw);
    yaw += 0.1 * std::tan(steer) / 0.33;
  }
  return text + R"({"type":"lap_end"})" + "\n";
}

std::vector<std::string> seeds() {
  return {
      drive(230), drive(5),
      "{\"type\":\"recording\"}\n{\"type\":\"tick\",\"time\":0,\"odometry\":[null,1,2,3],\"command\":[0]}\n"};
}

bool run(std::string_view bytes) {
  try {
    const auto samples = tools::read_driven_samples(scratch_file("drive.jsonl", bytes));
    testing::check_identification(vehicle::identify(samples));
    return true;
  } catch (const IoError&) {
    return false;
  } catch (const std::invalid_argument&) {  // of identify: too few samples
    return false;
  }
}

const Target target("json_recording", 1 << 15, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
