#pragma once

#include <deque>

#include "logic/installed.hpp"
#include "logic/localiser_core.hpp"
#include "logic/planner_core.hpp"
#include "logic/simulated_car.hpp"
#include "slalom/sim/pure_pursuit.hpp"
#include "support/allocations.hpp"

namespace slalom::nodes::testing {

struct StampedPose {
  Stamp stamp = 0;
  maps::Pose pose;
};

/// The transforms from one frame to another of the last ten seconds: like tf2, which these tests do without,
/// it interpolates, discards what is not finite and never extrapolates.
class TransformHistory {
 public:
  void add(const StampedPose& entry) {
    const auto& [stamp, pose] = entry;
    if (!std::isfinite(pose.x) || !std::isfinite(pose.y) || !std::isfinite(pose.yaw)) return;
    if (!past_.empty() && stamp <= past_.back().stamp) return;
    past_.push_back(entry);
    constexpr Stamp longest = 10'000'000'000;  // ns
    while (past_.back().stamp - past_.front().stamp > longest) past_.pop_front();
  }
  void clear() { past_.clear(); }

  bool knows(Stamp stamp) const {
    return !past_.empty() && past_.front().stamp <= stamp && stamp <= past_.back().stamp;
  }
  /// Throws std::runtime_error if the pose of this time is not known.
  maps::Pose at(Stamp stamp) const {
    if (past_.empty()) throw std::runtime_error("there is no transform");
    if (!knows(stamp)) throw std::runtime_error("the lookup would require extrapolation");
    const auto after =
        std::find_if(past_.begin(), past_.end(), [=](auto& each) { return each.stamp >= stamp; });
    const maps::Pose& next = after->pose;
    if (after->stamp == stamp) return next;
    const auto& [before, last] = *(after - 1);
    const double share = in_seconds(stamp - before) / in_seconds(after->stamp - before);
    return {last.x + share * (next.x - last.x), last.y + share * (next.y - last.y),
            last.yaw + share * maps::wrap_angle(next.yaw - last.yaw)};
  }

 private:
  std::deque<StampedPose> past_;  ///< by their stamps
};

/// A scan with its own ranges (m); those of `view` are set when it is heard.
struct Scan {
  Stamp stamp = 0;
  std::vector<float> ranges;
  maps::LaserScanView view;
  double angle_max = 0;  ///< rad
};

/// The messages of a period, in the order of their arrival.
struct Messages {
  std::vector<OdometrySample> odometry;
  std::vector<StampedPose> transforms;  ///< from the odometry frame to the car
  std::vector<Scan> scans;
};

class Drive;

/// A fault between car and nodes.
struct Fault {
  std::string name, reason;                            ///< words in the logged reason
  std::function<void(Drive&, Messages&)> change = {};  ///< changes the messages of each period
  std::function<void(Drive&)> begin = {}, end = {};    ///< called once
  double within = 1;                                   ///< s, until the nodes stop the car
  bool lasts = true;                                   ///< whether the car stays stopped until `end`
};

/// How a drive differs from the usual one.
struct DriveSetup {
  std::string course = "wren", others = "none";
  std::uint64_t seed = 1;
  int parked = 3;
  int view_port = 0;
  double other_speed = 0;  ///< share of the course's speeds of a car that starts 5 m ahead; 0: there is none
};

/// A simulated car among three parked ones, its planner and localiser, with simulated clocks.
class Drive {
 public:
  explicit Drive(DriveSetup setup = {}) : setup_(std::move(setup)) {
    commands_.reserve(20000);  // so that a command allocates nothing
    planner_.change({{"svg_mppi.samples", "500"}});
    planner_.use_course();
    start_localiser();
  }

  void begin(const Fault& fault) {
    fault_ = fault;
    if (fault_.begin) fault_.begin(*this);
  }
  void end() {
    const Fault ended = std::exchange(fault_, {});
    if (ended.end) ended.end(*this);
  }
  void end_localiser() { localiser_.reset(); }
  /// Starts a localiser that continues from the place that an earlier one has kept.
  void start_localiser() {
    const LocaliserCore::Settings settings{.course = place(setup_), .earlier = kept_};
    const auto say = log("localiser");
    localiser_.emplace(
        settings, clocks_, transforms(),
        LocaliserCore::Outputs{[](const maps::Pose&, const vehicle::LocaliserOutput&, Stamp) {},
                               [this](const maps::Pose& frame, Stamp stamp) {
                                 map_to_odometry_.add({stamp, frame});
                               },
                               [](const maps::OccupancyGrid&) {}, say, say});
    localiser_->use_course();
  }
  /// The localiser hears the map of the course, with its cells scaled.
  void hear_map(double scale) {
    maps::OccupancyGrid map = course_.map;
    map.resolution *= scale;
    localiser_->hear_map(map);
  }
  /// The clock of the stamps jumps, s.
  void jump(double seconds) { ahead_ += seconds; }

  /// Drives until something holds, for at most `most` (s). Returns whether it holds.
  template <class Holds>
  bool run_until(double most, Holds&& holds) {
    for (const double begin = time_; time_ < begin + most;) {
      step();
      if (holds()) return true;
    }
    return false;
  }
  void run(double seconds) {
    run_until(seconds, [] { return false; });
  }

  PlannerCore& planner() { return planner_; }
  const SimulatedCar& car() const { return car_; }
  /// The way (m) along the course by which the other car is ahead, at most half a lap.
  double other_ahead() const {
    const sim::World& world = car_.world();
    const double length = world.track().lap_path()->length();
    const auto arc = [&](std::size_t car) {
      return world.track()
          .lap_path()
          ->project({world.state(car).x, world.state(car).y, world.state(car).yaw})
          .arc;
    };
    return std::remainder(arc(1) - arc(0), length);
  }
  /// All commands that were sent.
  std::vector<Command> commands() const {
    std::vector<Command> all;
    for (const Sent& each : commands_) all.push_back(each.command);
    return all;
  }
  /// The number of allocations of the planner, from a scan to its command, since the last call.
  long allocations() { return std::exchange(allocations_, 0); }
  double time() const { return time_; }                     ///< s
  double speed() const { return car_.odometry().speed(); }  ///< m/s
  bool car_stands() const { return std::abs(speed()) < 0.2; }
  /// Whether the commands of the last 0.3 s drive, or stop.
  bool drives() const {
    return all_of_last(0.3, [](double speed) { return speed > 0.2; });
  }
  bool stops() const {
    return all_of_last(0.3, [](double speed) { return speed == 0; });
  }
  /// Whether commands to stop have lasted for 0.2 s since a time.
  bool has_stopped_since(double since) const {
    const auto stopped = [&](const Sent& c) { return c.time >= since && c.command.speed == 0; };
    const auto first = std::find_if(commands_.begin(), commands_.end(), stopped);
    const auto last = std::find_if(commands_.rbegin(), commands_.rend(), stopped);
    return first != commands_.end() && last->time - first->time > 0.2;
  }
  /// The number of lines with these words that were logged since a time.
  long count_said(const std::string& words, double since) const {
    return std::count_if(said_.begin(), said_.end(), [&](const Line& line) {
      return line.time >= since && line.text.find(words) != std::string::npos;
    });
  }
  /// Whether a reason for a stop with these words has been logged since a time.
  bool has_said(const std::string& words, double since) const {
    return std::any_of(said_.begin(), said_.end(), [&](const Line& line) {
      return line.time >= since && is_reason(line) && line.text.find(words) != std::string::npos;
    });
  }
  /// The first command that is not finite or not within the limits of the car, or the first reason that
  /// follows another one of its node within a second; empty if there is none.
  std::string mistake() const {
    for (const auto& [time, command] : commands_)
      if (!(std::abs(command.steer) <= 0.4189 + 1e-9 && std::abs(command.speed) <= 12))
        return "the command at " + std::to_string(time) + " s";
    std::map<std::string, double> last;
    for (const Line& line : said_)
      if (is_reason(line) && line.time - std::exchange(last[line.node], line.time) < 0.99) return line.text;
    return "";
  }
  std::string log() const {
    std::string text;
    for (const Line& line : said_)
      text += std::to_string(line.time) + " s: " + line.node + ": " + line.text + "\n";
    return text;
  }

 private:
  static std::string place(const DriveSetup& setup) { return SLALOM_COURSES "/" + setup.course; }
  static constexpr double period = 0.025;  ///< s, of the car

  struct Sent {
    double time;  // s
    Command command;
  };
  struct Line {
    double time;  // s
    std::string node, text;
  };

  static bool is_reason(const Line& line) {
    return line.text.starts_with("stopping:") || line.text.starts_with("braking:") ||
           line.text.starts_with("localisation:");
  }
  std::function<void(const std::string&)> log(const char* node) {
    return [this, node](const std::string& text) { said_.push_back({time_, node, text}); };
  }
  template <class Holds>
  bool all_of_last(double seconds, Holds&& holds) const {
    int count = 0;
    for (auto c = commands_.rbegin(); c != commands_.rend() && c->time >= time_ - seconds; ++c, ++count)
      if (!holds(c->command.speed)) return false;
    return count > 3;
  }

  template <class Action>
  void count_allocations(Action&& action) {
    const long before = slalom::testing::allocations();
    action();
    allocations_ += slalom::testing::allocations() - before;
  }
  static PlannerCore::Settings planner_settings(const DriveSetup& setup) {
    return {.configuration = SLALOM_CONFIGS "/default.yaml",
            .course = place(setup),
            .others = setup.others,
            .view_port = setup.view_port};
  }
  Transforms transforms() {
    return {[this](Stamp at) { return map_to_odometry_.knows(at) && odometry_to_base_.knows(at); },
            [this](Stamp at) { return composed(map_to_odometry_.at(at), odometry_to_base_.at(at)); },
            [this](const std::string& frame) {
              if (frame == "unknown") throw std::runtime_error("there is no transform");
              const maps::Pose laser = car_.laser();
              return mount_of(laser.x, laser.y, 0, 0, 0, 0, 1);
            },
            [this] {
              map_to_odometry_.clear();
              odometry_to_base_.clear();
            }};
  }

  void step() {
    for (int ticks = 0; ticks < 5; ++ticks) {
      time_ += period / 5;
      if (localiser_) localiser_->tick();
      if (localiser_ && ++ticks_ % 40 == 0) kept_ = localiser_->reliable();
      count_allocations([this] { planner_.tick(); });
    }
    const bool commanded = !commands_.empty() && time_ - commands_.back().time < 0.2;
    Command other;
    if (other_) {
      const sim::CarState& at = car_.world().state(1);
      other = other_->command({at.x, at.y, at.yaw});
    }
    car_.step(commanded ? commands_.back().command : Command{}, other);
    Messages messages = messages_of_car();
    if (fault_.change) fault_.change(*this, messages);
    for (const StampedPose& pose : messages.transforms) odometry_to_base_.add(pose);
    for (const OdometrySample& m : messages.odometry) {
      if (localiser_) localiser_->hear_odometry(m);
      planner_.hear_odometry(m.stamp, m.speed);
    }
    for (Scan& m : messages.scans) {
      m.view.ranges = m.ranges;
      count_allocations([&] { planner_.hear_scan(m.stamp, "laser", m.view, m.angle_max); });
      if (localiser_) localiser_->hear_scan(m.stamp, "laser", m.view, m.angle_max);
      count_allocations([&] { planner_.tick(); });
    }
  }
  std::optional<maps::Pose> place_other() {
    if (setup_.other_speed == 0) return {};
    std::vector<sim::PathPoint> path;
    for (const vehicle::Waypoint& p : course_.waypoints)
      path.push_back({{p.x, p.y}, setup_.other_speed * p.speed});
    other_.emplace(path);
    double way = 0;
    std::size_t i = 1;
    for (; way < 5; ++i) way += maps::distance(path[i].point, path[i - 1].point);
    return maps::Pose{path[i].point.x, path[i].point.y, course_.waypoints[i].yaw};
  }
  Messages messages_of_car() const {
    const Stamp now = stamp_of(time_ + ahead_);
    const sim::WheelOdometry& wheels = car_.odometry();
    const maps::LaserScanView seen = car_.scan();
    Scan scan{now, {seen.ranges.begin(), seen.ranges.end()}, seen, 0};
    scan.view.range_min = 0.02;
    scan.angle_max = seen.angle_min + seen.angle_increment * (static_cast<double>(seen.ranges.size()) - 1);
    return {{{now, wheels.pose(), wheels.speed(), wheels.yaw_rate()}}, {{now, wheels.pose()}}, {scan}};
  }

  double time_ = 1000, ahead_ = 0;  // s
  Clocks clocks_{[this] { return time_ + ahead_; }, [this] { return time_; }};
  std::vector<Sent> commands_;
  std::vector<Line> said_;
  DriveSetup setup_;
  vehicle::Course course_ = load_course(place(setup_));
  std::optional<sim::PurePursuit> other_;
  SimulatedCar car_{course_, setup_.seed, setup_.parked, place_other()};
  TransformHistory map_to_odometry_, odometry_to_base_;
  Fault fault_;
  std::optional<KnownPose> kept_;  ///< by the localiser
  long ticks_ = 0, allocations_ = 0;
  PlannerCore planner_{
      planner_settings(setup_), clocks_, transforms(),
      PlannerCore::Outputs{[this](const Command& command) {
                             commands_.push_back({time_, command});
                           },
                           [](const vehicle::PlannerOutput&, Stamp) {}, [](const PlannerCore::Path&, bool) {},
                           log("planner"), log("planner")}};
  std::optional<LocaliserCore> localiser_;
};

}  // namespace slalom::nodes::testing
