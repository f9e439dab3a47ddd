// The identification of a car from a bag of ROS 1. The input is the numbers of its messages: seven of float32
// for each scan.
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"
#include "support/identification_promise.hpp"
#include "tools/recorded_drives/driven_samples.hpp"
#include "tools/recording/bag_writer.hpp"

namespace slalom::fuzz {
namespace {

using testing::Wire;
using Numbers = std::array<float, 7>;  // s since the scan before, x, y, yaw, speed, steering, commanded speed

std::string text_of(const Numbers& numbers) {
  std::string bytes(sizeof numbers, '\0');
  std::memcpy(bytes.data(), numbers.data(), sizeof numbers);
  return bytes;
}

/// A drive in curves, of a car that does what it is told.
std::string drive(int ticks) {
  std::string bytes;
  double x = 0, y = 0, yaw = 0;
  for (int i = 0; i < ticks; ++i) {
    const double steer = 0.3 * std::sin(0.1 * i);
    bytes += text_of({0.05F, static_cast<float>(x), static_cast<float>(y), static_cast<float>(yaw), 2.0F,
                      static_cast<float>(steer), 2.0F});
    x += 0.1 * std::cos(yaw);
    y += 0.1 * std::sin(yaw);
    yaw += 0.1 * std::tan(steer) / 0.33;
  }
  return bytes;
}

std::vector<std::string> seeds() {
  const float infinity = std::numeric_limits<float>::infinity(),
              nan = std::numeric_limits<float>::quiet_NaN();
  return {drive(230), drive(5),
          drive(110) + text_of({0.05F, nan, 1, 1, 2, 0, 2}) + drive(60) +
              text_of({0.05F, 1, 1, 1, 2, infinity, 2}) + drive(60)};
}

Wire odometry(double stamp, double x, double y, double yaw, double speed) {
  Wire wire;
  wire.header(stamp, "map").text("base");
  for (const double value : {x, y, 0.0, 0.0, 0.0, std::sin(yaw / 2), std::cos(yaw / 2)}) wire.put(value);
  return wire.zeros(36 * 8).put(speed).zeros(5 * 8).zeros(36 * 8);
}

std::string bag_of(std::string_view bytes) {
  testing::BagWriter bag;
  double stamp = 10;
  for (Numbers each; bytes.size() >= sizeof each; bytes.remove_prefix(sizeof each)) {
    std::memcpy(each.data(), bytes.data(), sizeof each);
    const auto [step, x, y, yaw, speed, steer, commanded] = each;
    if (step > 0 && step < 10) stamp += static_cast<double>(step);
    const double s = static_cast<double>(speed);
    bag.add("/odom", "nav_msgs/Odometry", odometry(stamp - 0.01, 0, 0, 0, s));
    bag.add("/pf/pose/odom", "nav_msgs/Odometry",
            odometry(stamp, static_cast<double>(x), static_cast<double>(y), static_cast<double>(yaw), s));
    Wire scan;
    scan.header(stamp, "laser");
    for (const float value : {-1.0F, 1.0F, 1.0F, 0.0F, 0.0F, 0.1F, 30.0F}) scan.put(value);
    bag.add("/scan", "sensor_msgs/LaserScan", scan.put(std::uint32_t{1}).put(1.5F).put(std::uint32_t{0}));
    bag.add("/drive", "ackermann_msgs/AckermannDriveStamped",
            Wire().header(stamp + 0.01, "").put(steer).zeros(4).put(commanded).zeros(8));
  }
  return bag.bytes();
}

bool run(std::string_view bytes) {
  try {
    testing::check_identification(
        vehicle::identify(tools::read_driven_samples(scratch_file("samples.bag", bag_of(bytes)))));
    return true;
  } catch (const IoError&) {
    return false;
  } catch (const std::invalid_argument&) {  // of identify: too few samples
    return false;
  }
}

const Target target("bag_samples", 8192, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
