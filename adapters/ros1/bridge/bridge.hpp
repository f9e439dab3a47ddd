#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/// Slalom for programs that are not compiled as C++20: Debian's ROS headers do not compile as that. Plain
/// structs, and classes that hide what they hold. Constructors throw std::exception with a message for a
/// person.
namespace slalom_bridge {

struct Pose {
  double x = 0, y = 0;  ///< m
  double yaw = 0;       ///< rad
};

struct Scan {
  const float* ranges = nullptr;  ///< m
  std::size_t count = 0;
  double angle_min = 0, angle_increment = 0;  ///< rad
  double range_min = 0, range_max = 0;        ///< m
};

struct Command {
  double steer = 0;  ///< rad
  double speed = 0;  ///< m/s
  bool ok = false;   ///< false: the car is to stop
  std::string why;   ///< in a word
  double effective_samples = 0;
  double update_time = 0;  ///< s
};

/// From scan and pose of the rear axle (map frame) to a command.
class Planner {
 public:
  /// `course` is a name or a folder, `configuration` a name or a file (empty: the defaults).
  Planner(const std::string& course, const std::string& configuration, const std::string& method);
  ~Planner();
  Command update(const Scan& scan, const Pose& pose, double speed);

 private:
  struct Hidden;
  std::unique_ptr<Hidden> hidden_;
};

struct Estimate {
  Pose pose;            ///< of the rear axle, map frame
  Pose odometry_frame;  ///< map frame
  double covariance[3][3] = {};
  bool usable = false;
  std::string status;
  double health = 0;
};

class Localiser {
 public:
  /// Starts at the course's start, or everywhere.
  Localiser(const std::string& course, bool everywhere, std::uint64_t seed);
  ~Localiser();
  Estimate update(const Scan& scan, const Pose& odometry, double stamp);
  void start_at(const Pose& pose);

 private:
  struct Hidden;
  std::unique_ptr<Hidden> hidden_;
};

/// The simulator as a car.
class World {
 public:
  World(const std::string& course, std::uint64_t seed, int obstacles);
  ~World();
  void reset();
  /// Moves by 25 ms under a command.
  void step(double steer, double speed);

  struct Reading {
    std::vector<float> ranges;
    double angle_min = 0, angle_increment = 0, range_max = 0;
    Pose odometry;  ///< of the rear axle, odometry frame
    Pose truth;     ///< of the rear axle, map frame
    double speed = 0, yaw_rate = 0;
    int laps = 0;
    int contacts = 0;
  };
  const Reading& reading() const;
  const std::vector<Pose>& obstacles() const;

 private:
  struct Hidden;
  std::unique_ptr<Hidden> hidden_;
};

}  // namespace slalom_bridge
