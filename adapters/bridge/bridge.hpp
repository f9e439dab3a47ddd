#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// Slalom for programs that are not compiled as C++20: Debian's ROS headers do not compile as that. Plain
/// structs, and classes that hide what they hold. Constructors, `change` and `use_*` throw std::exception
/// with a message for a person, and then nothing has changed.
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

/// A map as nav_msgs/OccupancyGrid has it: 0 free, 100 occupied, -1 unknown.
struct Grid {
  int width = 0, height = 0;
  double resolution = 0;  ///< m
  Pose origin;            ///< of the lower left corner of the first cell, map frame
  std::vector<std::int8_t> cells;
};

struct Waypoint {
  double x = 0, y = 0;  ///< m, map frame
  double yaw = 0;       ///< rad
  double speed = 0;     ///< m/s
};

struct Course {
  std::string name;
  Grid map;
  std::vector<Waypoint> waypoints;
  bool closed = true;
  Pose start;  ///< of the rear axle
};
/// `course` is a name or a folder.
Course load_course(const std::string& course);

/// A declared option as it is set.
struct Option {
  std::string name;  ///< "section/option", or "option" where there are no sections
  std::string type;  ///< "flag", "integer", "number", "numbers" or "choice"
  std::string value, unit, help;
  double min = 0, max = 0;
  std::vector<std::string> choices;
};
using Changes = std::vector<std::pair<std::string, std::string>>;  ///< names and values as text

struct Command {
  double steer = 0;  ///< rad
  double speed = 0;  ///< m/s
  bool ok = false;   ///< false: no plan, or none that is free; it brakes
  std::string status;
  double effective_samples = 0;
  double update_time = 0;  ///< s
  double state_cost = 0, collision_cost = 0, input_error = 0;
};

/// From scan and pose of the rear axle (map frame) to a command.
class Planner {
 public:
  /// `configuration` is a name or a file (empty: the classes' defaults).
  Planner(const std::string& configuration, const std::string& method);
  ~Planner();

  std::vector<Option> options() const;  ///< of vehicle, planner and the method
  void change(const Changes& changes);
  void use_path(const std::vector<Waypoint>& path);
  bool has_path() const;
  double control_period() const;  ///< s
  Pose laser() const;             ///< from the rear axle, as the options have it

  Command update(const Scan& scan, const Pose& pose, double speed);
  /// The states of the sequence sent last, map frame; empty where none was.
  const std::vector<Pose>& predicted() const;

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
  double health = 0, fit = 0, share = 0;  ///< 0 .. 1
  double effective_samples = 0;
  double update_time = 0;  ///< s
  int particles = 0;
  bool searching = false;
};

class Localiser {
 public:
  Localiser();
  ~Localiser();

  std::vector<Option> options() const;
  void change(const Changes& changes);
  void use_map(const Grid& map);
  bool has_map() const;
  Pose laser() const;  ///< from the rear axle, as the options have it

  void start_at(const Pose& pose);
  void start_everywhere();
  Estimate update(const Scan& scan, const Pose& odometry, double stamp);
  /// At most `most` of the particles.
  std::vector<Pose> particles(int most) const;

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
  const std::vector<Pose>& obstacles() const;  ///< of their middles
  Pose laser() const;                          ///< from the rear axle
  double car_length() const;                   ///< m
  double car_width() const;                    ///< m

 private:
  struct Hidden;
  std::unique_ptr<Hidden> hidden_;
};

}  // namespace slalom_bridge
