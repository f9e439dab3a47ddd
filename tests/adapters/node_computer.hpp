#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "faulty_car.hpp"
#include "logic/localiser_core.hpp"
#include "logic/planner_core.hpp"
#include "support/allocations.hpp"

namespace slalom::nodes::testing {

/// The transforms from one frame to another of the last ten seconds: like tf2, which these tests do without,
/// it interpolates, discards what is not finite and never extrapolates.
class TransformHistory {
 public:
  void add(Stamp stamp, const maps::Pose& pose) {
    if (!std::isfinite(pose.x) || !std::isfinite(pose.y) || !std::isfinite(pose.yaw)) return;
    if (!past_.empty() && stamp <= past_.back().stamp) return;
    past_.push_back({stamp, pose});
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
    const auto after = std::lower_bound(past_.begin(), past_.end(), stamp,
                                        [](const Entry& entry, Stamp time) { return entry.stamp < time; });
    if (after->stamp == stamp) return after->pose;
    const auto before = after - 1;
    const double share = in_seconds(stamp - before->stamp) / in_seconds(after->stamp - before->stamp);
    return {before->pose.x + share * (after->pose.x - before->pose.x),
            before->pose.y + share * (after->pose.y - before->pose.y),
            before->pose.yaw + share * maps::wrap_angle(after->pose.yaw - before->pose.yaw)};
  }

 private:
  struct Entry {
    Stamp stamp;
    maps::Pose pose;
  };
  std::deque<Entry> past_;  ///< by their stamps
};

inline constexpr const char* wren = SLALOM_COURSES "/wren";
inline constexpr double period = 0.025;  ///< s, of the car

/// The messages that the computer of a car sends.
struct ComputerOutputs {
  std::function<void(const Command&)> drive;
  std::function<void(const std::string& node, const std::string& line)> log;
};

/// Both nodes, and the transforms that they and the car publish.
class NodeComputer {
 public:
  NodeComputer(const Clocks& clocks, const ComputerOutputs& outputs)
      : clocks_(clocks),
        outputs_(outputs),
        laser_(SimulatedCar(load_course(wren), 1, 0).laser()),
        planner_(make_planner()) {
    planner_.change({{"svg_mppi.samples", "500"}});
    planner_.use_course();
    start_localiser({});
  }

  void begin(const Fault& fault) {
    fault_ = fault;
    if (!has("localiser", "dies")) return;
    localiser_.reset();
  }
  void end() {
    if (has("localiser", "dies")) start_localiser(kept_);
    fault_.reset();
  }

  void tick() {
    if (localiser_) localiser_->tick();
    // The nodes keep the place with each report.
    if (localiser_ && ++ticks_ % std::lround(1 / period) == 0) kept_ = localiser_->reliable();
    count_allocations([this] { planner_.tick(); });
  }
  void hear_map(const maps::OccupancyGrid& map) { localiser_->hear_map(map); }
  void hear_other_command() { planner_.hear_other_command("another"); }

  void hear(const OdometrySample& m) {
    // A fault of the odometry's stamps is none of the transforms.
    const Stamp shift = has("odometry", "stamp") ? -stamp_of(fault_->value) : 0;
    const Stamp shift_of_tf = has("tf", "stamp") ? stamp_of(fault_->value) : 0;
    if (!has("tf", "silent") && !has("tf", "not a number"))
      odometry_to_base_.add(m.stamp + shift + shift_of_tf, m.pose);
    if (localiser_) localiser_->hear_odometry(m);
    planner_.hear_odometry(m.stamp, m.speed);
  }
  void hear(const ScanMessage& m) {
    const maps::LaserScanView scan = m.view();
    count_allocations([&] { planner_.hear_scan(m.stamp, "laser", scan, m.angle_max); });
    if (localiser_) localiser_->hear_scan(m.stamp, "laser", scan, m.angle_max);
    count_allocations([&] { planner_.tick(); });
  }

  PlannerCore& planner() { return planner_; }
  /// The number of allocations of the planner, from a scan to its command, since the last call.
  long allocations() { return std::exchange(allocations_, 0); }

 private:
  bool has(const char* of, const char* change) const {
    return fault_ && fault_->of == of && fault_->change == change;
  }

  template <class Action>
  void count_allocations(Action&& action) {
    const long before = slalom::testing::allocations();
    allocations_of_outputs_ = 0;
    action();
    allocations_ += slalom::testing::allocations() - before - allocations_of_outputs_;
  }

  Transforms transforms() {
    return {[this](Stamp at) { return map_to_odometry_.knows(at) && odometry_to_base_.knows(at); },
            [this](Stamp at) { return composed(map_to_odometry_.at(at), odometry_to_base_.at(at)); },
            [this](const std::string& frame) {
              if (frame == "unknown") throw std::runtime_error("there is no transform");
              return mount_of(laser_.x, laser_.y, 0, 0, 0, 0, 1);
            },
            [this] {
              map_to_odometry_.clear();
              odometry_to_base_.clear();
            }};
  }

  PlannerCore make_planner() {
    PlannerCore::Settings settings;
    settings.configuration = SLALOM_CONFIGS "/default.yaml";
    settings.course = wren;
    const auto log = [this](const std::string& line) { outputs_.log("planner", line); };
    return {settings,
            clocks_,
            transforms(),
            {[this](const Command& command) {
               const long before = slalom::testing::allocations();
               outputs_.drive(command);
               allocations_of_outputs_ += slalom::testing::allocations() - before;
             },
             [](const vehicle::PlannerOutput&, Stamp) {}, [](const PlannerCore::Path&, bool) {}, log, log}};
  }

  void start_localiser(const std::optional<KnownPlace>& earlier) {
    LocaliserCore::Settings settings;
    settings.course = wren;
    settings.earlier = earlier;
    const auto log = [this](const std::string& line) { outputs_.log("localiser", line); };
    localiser_.emplace(
        settings, clocks_, transforms(),
        LocaliserCore::Outputs{
            [](const maps::Pose&, const vehicle::LocaliserOutput&, Stamp) {},
            [this](const maps::Pose& frame, Stamp stamp) { map_to_odometry_.add(stamp, frame); },
            [](const maps::OccupancyGrid&) {}, log, log});
    localiser_->use_course();
  }

  Clocks clocks_;
  ComputerOutputs outputs_;
  maps::Pose laser_;
  TransformHistory map_to_odometry_, odometry_to_base_;
  std::optional<Fault> fault_;
  std::optional<KnownPlace> kept_;
  long ticks_ = 0;
  long allocations_ = 0, allocations_of_outputs_ = 0;
  PlannerCore planner_;
  std::optional<LocaliserCore> localiser_;
};

}  // namespace slalom::nodes::testing
