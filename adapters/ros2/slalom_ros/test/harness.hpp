#pragma once

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <rclcpp/rclcpp.hpp>

/// The parts of the tests of slalom_ros and slalom_nav2 that are the same.
namespace slalom_ros_test {

inline double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

inline void expect(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error("FAILED: " + what);
}

/// A program that runs until this ends.
class Process {
 public:
  /// Throws std::runtime_error if the program cannot be started.
  explicit Process(const std::vector<std::string>& words) {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    if (posix_spawn(&id_, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0)
      throw std::runtime_error(words[0] + ": cannot be started");
  }
  ~Process() { end(SIGINT); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Sends a signal and waits for the end.
  void end(int signal) {
    if (id_ <= 0) return;
    ::kill(id_, signal);
    waitpid(id_, nullptr, 0);
    id_ = 0;
  }

 private:
  pid_t id_ = 0;
};

/// The node of a test, which waits for what the nodes under test do.
class TestNode {
 public:
  explicit TestNode(const std::string& name) : node(std::make_shared<rclcpp::Node>(name)) {
    executor_.add_node(node);
  }
  virtual ~TestNode() = default;

  /// Runs until something holds. Throws if it does not within this time (s).
  void wait(const std::string& what, double seconds, const std::function<bool()>& holds) {
    const double begin = steady_seconds();
    while (!holds()) {
      expect(steady_seconds() - begin < seconds, what + "\n" + log());
      spin();
    }
    std::printf("ok: %s (%.1f s)\n", what.c_str(), steady_seconds() - begin);
    std::fflush(stdout);
  }
  void run(double seconds) {
    for (const double begin = steady_seconds(); steady_seconds() - begin < seconds;) spin();
  }

  /// Calls a service and returns its answer. Throws if there is none within a minute.
  template <class Service>
  typename Service::Response::SharedPtr call(
      const std::string& name, const typename Service::Request& request = typename Service::Request()) {
    const auto client = node->create_client<Service>(name);
    wait(name + ": is there", 30, [&] { return client->service_is_ready(); });
    auto answer = client->async_send_request(std::make_shared<typename Service::Request>(request));
    wait(name + ": answers", 60,
         [&] { return answer.wait_for(std::chrono::seconds(0)) == std::future_status::ready; });
    return answer.get();
  }

  rclcpp::Node::SharedPtr node;

 protected:
  virtual void step() {}                          ///< each millisecond
  virtual std::string log() const { return ""; }  ///< the text that a failure prints

 private:
  void spin() {
    executor_.spin_some();
    step();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  rclcpp::executors::SingleThreadedExecutor executor_;
};

/// Runs a test with the only argument of the program. Returns the exit status.
inline int run_test(int argc, char** argv, void (*test)(const std::string& argument)) try {
  rclcpp::init(1, argv);
  expect(argc == 2, "must have one argument");
  test(argv[1]);
  rclcpp::shutdown();
  return 0;
} catch (const std::exception& error) {
  std::printf("%s\n", error.what());
  return 1;
}

}  // namespace slalom_ros_test
