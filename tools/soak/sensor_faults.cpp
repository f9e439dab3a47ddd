#include "tools/soak/sensor_faults.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "slalom/sim/world.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::tools {
namespace {

using vehicle::PlannerStatus;

constexpr double interval = 2, duration = 0.3;  // s, between the beginnings of faults, and of each
constexpr double max_return_time = 0.1;         // s
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// One kind of fault.
struct Fault {
  const char* name;
  PlannerStatus expected;  ///< PlannerStatus::ok: the planner cannot notice it
};
constexpr std::array faults = {Fault{"ranges without a number", PlannerStatus::bad_scan},
                               Fault{"a scan without beams", PlannerStatus::bad_scan},
                               Fault{"a scan that stands still", PlannerStatus::ok},
                               Fault{"half of the beams lost", PlannerStatus::ok},
                               Fault{"a pose without a number", PlannerStatus::bad_odometry},
                               Fault{"a speed of 1e6 m/s", PlannerStatus::bad_odometry},
                               Fault{"a pose 3 m away", PlannerStatus::ok}};

/// A drive whose inputs can be spoilt.
class FaultyDrive {
 public:
  FaultyDrive(const Scenario& scenario, const std::string& method, std::uint64_t seed)
      : random_(seed),
        options_(scenario.configuration.planner),
        world_(scenario.environment->world_options(), scenario.environment->track),
        planner_(make_planner(scenario, method)) {
    planner_.reset(seed);
    world_.reset(seed, {&scenario.environment->start, 1});
    command_period_ = static_cast<int>(std::lround(options_.control_period / world_.options().time_step));
  }

  FaultRecord run(double seconds, const std::atomic<bool>& cancel) {
    while (world_.time() < seconds && record_.broken.empty() && !cancel) {
      const double phase = std::fmod(world_.time(), interval);
      const bool begins = phase < options_.control_period && world_.time() > interval / 2;
      if (begins) {
        fault_ = &faults[std::uniform_int_distribution<std::size_t>(0, faults.size() - 1)(random_)];
        ++record_.faults;
      }
      if (fault_ && phase >= duration) ended_ = fault_, ended_at_ = world_.time(), fault_ = nullptr;
      step();
    }
    return record_;
  }

 private:
  static vehicle::Planner make_planner(const Scenario& scenario, const std::string& method) {
    const vehicle::Configuration& configuration = scenario.configuration;
    return {configuration.planner, vehicle::make_vehicle_model(configuration.vehicle),
            scenario.environment->path, vehicle::make_solver(configuration, method, scenario.lap.threads)};
  }

  void step() {
    const sim::Observation seen = world_.observe(0);
    const maps::Point axle = maps::transform(seen.pose, {-world_.options().car.rear_length, 0});
    vehicle::PlannerInput input{seen.scan, {{axle.x, axle.y, seen.pose.yaw}, seen.speed}};
    if (!fault_ || fault_->name != faults[2].name)
      ranges_.assign(seen.scan.ranges.begin(), seen.scan.ranges.end());
    if (fault_) spoil(input);
    const vehicle::PlannerOutput& output = planner_.update(input);
    check(output, seen.speed);
    for (int k = 0; k < command_period_; ++k) world_.step({&output.command, 1});
  }

  void spoil(vehicle::PlannerInput& input) {
    const auto is = [&](std::size_t kind) { return fault_ == &faults[kind]; };
    if (is(0)) std::fill(ranges_.begin(), ranges_.end(), static_cast<float>(nothing));
    if (is(3))
      for (std::size_t i = 0; i < ranges_.size(); i += 2) ranges_[i] = static_cast<float>(nothing);
    input.scan.ranges = is(1) ? std::span<const float>{} : std::span<const float>(ranges_);
    if (is(4)) input.odometry.pose.x = nothing;
    if (is(5)) input.odometry.speed = 1e6;
    if (is(6)) input.odometry.pose.y += 3;
  }

  void check(const vehicle::PlannerOutput& output, double speed) {
    const Command& command = output.command;
    const auto broken = [&](const std::string& rule) {
      if (record_.broken.empty())
        record_.broken = rule + " at " + std::to_string(world_.time()) + " s" +
                         (fault_ ? std::string(", with ") + fault_->name : "");
    };
    if (!std::isfinite(command.steer) || !std::isfinite(command.speed))
      broken("a command that is not finite");
    if (std::abs(command.steer) > options_.steer_limit || command.speed > options_.max_speed)
      broken("a command beyond the limits");
    const bool unusable =
        output.status == PlannerStatus::bad_scan || output.status == PlannerStatus::bad_odometry;
    if (fault_ && fault_->expected != PlannerStatus::ok) {
      if (output.status != fault_->expected) broken(std::string("status ") + name(output.status));
      if (command.speed > std::max(speed, 0.0)) broken("a command that is faster than the car");
    } else if (unusable && !(ended_ && world_.time() - ended_at_ < max_return_time)) {
      broken(std::string("status ") + name(output.status) + " without a fault of that kind");
    }
    if (ended_ && !fault_ && !unusable) {
      record_.slowest_return = std::max(record_.slowest_return, world_.time() - ended_at_);
      ended_ = nullptr;
    }
  }

  std::mt19937_64 random_;
  vehicle::PlannerOptions options_;
  sim::World world_;
  vehicle::Planner planner_;
  int command_period_ = 1;  ///< steps of the world
  std::vector<float> ranges_;
  const Fault *fault_ = nullptr,
              *ended_ = nullptr;  ///< fault of now, and the last one until the planner plans again
  double ended_at_ = 0;           ///< s
  FaultRecord record_;
};

}  // namespace

FaultRecord drive_with_sensor_faults(const Scenario& scenario, const std::string& method, std::uint64_t seed,
                                     double seconds, const std::atomic<bool>& cancel) {
  return FaultyDrive(scenario, method, seed).run(seconds, cancel);
}

}  // namespace slalom::tools
