#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Slalom for programs that are not compiled as C++20, such as nodes that use the ROS headers of Debian.
/// Plain structs, and classes that hide their implementation. Constructors, `change` and `use_*` throw
/// std::exception with a message for the user; the object is then unchanged.
namespace slalom_bridge {

/// A position and heading in the plane.
struct Pose {
  double x = 0, y = 0;  ///< m
  double yaw = 0;       ///< rad
};

/// A planar LiDAR scan; `ranges` must stay valid while it is used.
struct Scan {
  const float* ranges = nullptr;  ///< m
  std::size_t count = 0;
  double angle_min = 0, angle_increment = 0;  ///< rad
  double range_min = 0, range_max = 0;        ///< m
};

/// A map as in nav_msgs/OccupancyGrid: 0 free, 100 occupied, -1 unknown.
struct Grid {
  int width = 0, height = 0;
  double resolution = 0;  ///< m
  Pose origin;            ///< of the lower left corner of the first cell, map frame
  std::vector<std::int8_t> cells;
};

/// A point of the path.
struct Waypoint {
  double x = 0, y = 0;  ///< m, map frame
  double yaw = 0;       ///< rad
  double speed = 0;     ///< m/s
};

/// A course to drive on.
struct Course {
  std::string name;
  Grid map;
  std::vector<Waypoint> waypoints;
  bool closed = true;
  Pose start;  ///< of the rear axle
};
/// Loads a course. `course` is a name or a folder. Throws std::exception.
Course load_course(const std::string& course);

/// A declared option and its present value.
struct Option {
  std::string name;  ///< "section/option", or "option" where there are no sections
  std::string type;  ///< "flag", "integer", "number", "numbers" or "choice"
  std::string value, unit, help;
  double min = 0, max = 0;
  std::vector<std::string> choices;
  std::string rule;  ///< of the range, for instance "must be in [1, 4096]"; empty for flags and choices
};
using Changes = std::vector<std::pair<std::string, std::string>>;  ///< names and values as text

/// The result of an update of the planner. Steering and speed are always finite and within their limits.
struct Command {
  double steer = 0;              ///< rad
  double speed = 0;              ///< m/s
  bool ok = false;               ///< false: there is no plan without collision, and the car brakes
  std::string_view status;       ///< name of the planner's status, valid for the whole run
  double effective_samples = 0;  ///< effective sample size of the solver
  double update_time = 0;        ///< s, wall-clock
  int corrections = 0;           ///< values that the planner's final check changed; 0 in normal operation
  /// What is known of the car and the ground where the vehicle model's tyres slip; else a friction of 0.
  double friction = 0, friction_deviation = 0, cautious_friction = 0, confidence = 0;
  double steering_gain = 1, delay = 0;  ///< the latter in s
  double yaw_rate = 0, slip = 0;        ///< rad/s, rad, of the observer
  /// Terms of the mean sequence cost and the sum of |steering| (rad) over the control sequence.
  double state_cost = 0, collision_cost = 0, input_error = 0;
};

/// The samples of an inertial measurement unit since the last update: base frame, x ahead, y to the left.
class ImuSamples {
 public:
  /// rad/s, m/s^2. Samples that no car has (see slalom::ImuReading) are ignored.
  void add(double yaw_rate, double forward, double leftward);
  /// The number of samples since the last `clear`.
  int count() const { return count_; }
  double yaw_rate() const { return yaw_rate_ / count_; }  ///< rad/s, mean; needs a sample
  double forward() const { return forward_ / count_; }    ///< m/s^2, mean; needs a sample
  double leftward() const { return leftward_ / count_; }  ///< m/s^2, mean; needs a sample
  void clear() { *this = {}; }

 private:
  double yaw_rate_ = 0, forward_ = 0, leftward_ = 0;
  int count_ = 0;
};

/// Computes a command from a scan and the pose of the rear axle (map frame).
class Planner {
 public:
  /// `configuration` is a name or a file; empty means the defaults of the classes.
  Planner(const std::string& configuration, const std::string& method);
  ~Planner();

  std::vector<Option> options() const;               ///< of vehicle problem, planner and method
  void change(const Changes& changes);               ///< sets options; the planner starts anew
  void use_path(const std::vector<Waypoint>& path);  ///< throws if the path is invalid
  bool has_path() const;                             ///< whether a path was set
  double control_period() const;                     ///< s
  Pose laser() const;                                ///< pose relative to the rear axle, from the options
  /// Writes all options as a configuration file; an old file is replaced.
  void save(const std::string& file) const;

  /// `speed` in m/s. `imu` has the samples since the last update; none where there is no unit. Does not
  /// throw.
  Command update(const Scan& scan, const Pose& pose, double speed, const ImuSamples& imu = {});
  /// The predicted states of the last control sequence, map frame; empty if there is none.
  const std::vector<Pose>& predicted() const;

 private:
  struct Hidden;
  std::unique_ptr<Hidden> hidden_;
};

/// Counts the laps of a car along a closed path. Driving backwards counts down.
class LapCount {
 public:
  LapCount();  ///< without a path; counts nothing
  /// Throws std::exception if the path has fewer than 3 points or points that are not finite.
  explicit LapCount(const std::vector<Waypoint>& path);
  ~LapCount();
  LapCount(LapCount&&) noexcept;
  LapCount& operator=(LapCount&&) noexcept;

  bool counts() const { return hidden_ != nullptr; }  ///< whether it has a path
  void restart();                                     ///< counts from the next pose on
  void update(const Pose& pose, double time);         ///< s; neither allocates nor throws
  int laps() const;                                   ///< whole laps

 private:
  struct Hidden;
  std::unique_ptr<Hidden> hidden_;
};

/// The result of an update of the localiser.
struct Estimate {
  Pose pose;                              ///< of the rear axle, map frame
  Pose odometry_frame;                    ///< pose of the odometry frame in the map frame
  double covariance[3][3] = {};           ///< of x, y (m) and yaw (rad)
  bool usable = false;                    ///< whether the pose can be used for driving
  std::string_view status;                ///< name of the localiser's status, valid for the whole run
  double health = 0, fit = 0, share = 0;  ///< 0 .. 1
  double effective_samples = 0;
  double update_time = 0;  ///< s
  int particles = 0;
  bool searching = false;
};

/// Estimates the pose of the car in a map from scans and odometry.
class Localiser {
 public:
  Localiser();
  ~Localiser();

  std::vector<Option> options() const;
  void change(const Changes& changes);
  void use_map(const Grid& map);
  bool has_map() const;
  Pose laser() const;  ///< pose relative to the rear axle, from the options

  void start_at(const Pose& pose);
  void start_everywhere();
  Estimate update(const Scan& scan, const Pose& odometry, double stamp);
  /// Poses of at most `most` particles.
  std::vector<Pose> particles(int most) const;

 private:
  struct Hidden;
  std::unique_ptr<Hidden> hidden_;
};

/// A simulated car on a course with parked cars.
class World {
 public:
  World(const std::string& course, std::uint64_t seed, int obstacles);
  ~World();
  void reset();
  /// Simulates 25 ms. `steer` in rad, `speed` in m/s.
  void step(double steer, double speed);

  /// Measurements and true state after a step.
  struct Reading {
    std::vector<float> ranges;
    double angle_min = 0, angle_increment = 0, range_max = 0;
    Pose odometry;  ///< of the rear axle, odometry frame
    Pose truth;     ///< of the rear axle, map frame
    double speed = 0, yaw_rate = 0;
    int laps = 0;
    int contacts = 0;  ///< number of collisions
  };
  const Reading& reading() const;
  const std::vector<Pose>& obstacles() const;  ///< of their centres
  Pose laser() const;                          ///< pose relative to the rear axle
  double car_length() const;                   ///< m
  double car_width() const;                    ///< m

 private:
  struct Hidden;
  std::unique_ptr<Hidden> hidden_;
};

}  // namespace slalom_bridge
