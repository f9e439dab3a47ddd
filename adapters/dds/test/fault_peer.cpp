// A car on the topics of ROS 2 for fault_test.py. Reads rows of faults.csv, each of which begins this fault,
// and `end`, which ends it. Prints `command SPEED` for each command that it receives, and `speed SPEED` for
// each of its steps (m/s). Its clock, on the topic `clock`, is that of the system with jumps.
//
//   slalom_ros2_fault_peer COURSE OBSTACLES DOMAIN
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <optional>
#include <stdexcept>
#include <thread>

#include "car.hpp"

namespace {

using slalom_ros2_test::Car;
using slalom_ros2_test::now;

/// The standard input, as far as it has come.
class Input {
 public:
  /// Takes what has come since the last call. Returns whether the input goes on.
  bool read() {
    pollfd readable{STDIN_FILENO, POLLIN, 0};
    while (poll(&readable, 1, 0) > 0) {
      char bytes[1024];
      const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
      if (count <= 0) return false;
      text_.append(bytes, static_cast<std::size_t>(count));
    }
    return true;
  }
  /// The next complete line; nothing if there is none.
  std::optional<std::string> line() {
    const auto end = text_.find('\n');
    if (end == std::string::npos) return std::nullopt;
    const std::string line = text_.substr(0, end);
    text_.erase(0, end + 1);
    return line;
  }

 private:
  std::string text_;
};

void drive(Car& car) {
  constexpr double period = 0.025, longest_pause = 0.5;  // s
  Input input;
  double ahead = 0, due = now();  // s
  while (input.read()) {
    while (const auto line = input.line()) {
      if (*line == "end") {
        car.end();
        continue;
      }
      const auto fault = slalom_bridge::testing::parse_fault(*line);
      car.begin(fault);
      if (fault.of == "clock") ahead += fault.value;
    }
    car.send_clock(now() + ahead);
    if (now() - due > longest_pause) due = now();  // this process was stopped
    if (now() >= due) {
      car.step(due + ahead);
      due += period;
      std::printf("speed %.3f\n", car.reading().speed);
      std::fflush(stdout);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 4) throw std::invalid_argument("usage: slalom_ros2_fault_peer COURSE OBSTACLES DOMAIN");
  Car car(argv[1], std::stoi(argv[2]), std::stoi(argv[3]));
  car.on_command = [](double speed) { std::printf("command %.4f\n", speed); };
  drive(car);
} catch (const std::exception& error) {
  std::fprintf(stderr, "slalom_ros2_fault_peer: %s\n", error.what());
  return 1;
}
