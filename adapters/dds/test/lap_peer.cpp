// A car that drives laps on the topics of ROS 2. Succeeds if the laps are driven without a collision, and the
// node is announced and sends its transform.
//
//   slalom_ros2_peer COURSE LAPS OBSTACLES DOMAIN
#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <thread>

#include "car.hpp"

namespace {

using slalom_ros2_test::Car;
using slalom_ros2_test::now;

/// Runs the world until `holds` has been true for `lasting` (s). Returns false if that takes longer than
/// `most` (s).
template <class Holds>
bool run_until(Car& car, double& due, const char* what, Holds&& holds, double lasting, double most) {
  const double begin = now();
  double since = now();
  while (now() - begin < most) {
    std::this_thread::sleep_for(std::chrono::duration<double>(std::max(0.0, due - now())));
    car.step(due);
    due += 0.025;
    if (!holds()) {
      since = now();
      continue;
    }
    if (now() - since < lasting) continue;
    std::printf("ok: %s (%.1f s)\n", what, now() - begin);
    std::fflush(stdout);
    return true;
  }
  std::printf("FAILED: %s: timed out after %.0f s\n", what, most);
  return false;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 5) throw std::invalid_argument("usage: slalom_ros2_peer COURSE LAPS OBSTACLES DOMAIN");
  const int laps = std::stoi(argv[2]);
  Car car(argv[1], std::stoi(argv[3]), std::stoi(argv[4]));
  double due = now();
  bool well = run_until(
      car, due, "commanded to drive", [&] { return car.commanded_speed() > 0.3; }, 0.3, 30);
  const int before = car.reading().laps;
  well = well && run_until(
                     car, due, "laps", [&] { return car.reading().laps >= before + laps; }, 0, 60.0 * laps);
  std::printf("%d laps, %d contacts, %ld commands; node announced: %s; transform from map heard: %s\n",
              car.reading().laps, car.reading().contacts, car.commands(), car.knows_node() ? "yes" : "no",
              car.heard_transform() ? "yes" : "no");
  return well && car.reading().contacts == 0 && car.knows_node() && car.heard_transform() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "slalom_ros2_peer: %s\n", error.what());
  return 1;
}
