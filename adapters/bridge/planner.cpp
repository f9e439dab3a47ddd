#include <cmath>
#include <stdexcept>

#include "bridge/convert.hpp"
#include "slalom/evaluation/result_folder.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom_bridge {

using slalom::vehicle::PlannerStatus;

struct Planner::Hidden {
  std::string method;
  slalom::vehicle::Configuration settings;
  std::vector<slalom::maps::ReferencePoint> path;
  std::unique_ptr<slalom::vehicle::Planner> planner;
  std::vector<Pose> predicted;

  std::unique_ptr<slalom::vehicle::Planner> make(
      const slalom::vehicle::Configuration& with,
      const std::vector<slalom::maps::ReferencePoint>& along) const {
    return std::make_unique<slalom::vehicle::Planner>(with.planner,
                                                      slalom::vehicle::make_vehicle_model(with.vehicle),
                                                      along, slalom::vehicle::make_solver(with, method, 1));
  }
};

Planner::Planner(const std::string& configuration, const std::string& method)
    : hidden_(std::make_unique<Hidden>()) {
  hidden_->method = method;
  slalom::solver_options(method);  // throws on an unknown method
  if (configuration.empty()) return;
  const auto roots = slalom::vehicle::configuration_roots(program_folder());
  hidden_->settings =
      slalom::vehicle::load_configuration(slalom::vehicle::find_configuration(configuration, roots), roots);
}
Planner::~Planner() = default;

std::vector<Option> Planner::options() const {
  std::vector<Option> all;
  for (const auto& section : slalom::vehicle::list_sections(hidden_->settings)) {
    if (section.name != "vehicle" && section.name != "planner" && section.name != hidden_->method) continue;
    for (const auto& entry : section.options) all.push_back(plain(section.name + "/", entry));
  }
  return all;
}

void Planner::change(const Changes& changes) {
  slalom::vehicle::Configuration changed = hidden_->settings;
  for (const auto& [name, text] : changes) {
    std::string key = name;
    if (const auto slash = key.find('/'); slash != std::string::npos) key[slash] = '.';
    slalom::vehicle::set_option(changed, key, text, hidden_->method);
  }
  if (!hidden_->path.empty()) hidden_->planner = hidden_->make(changed, hidden_->path);
  hidden_->settings = changed;
}

void Planner::use_path(const std::vector<Waypoint>& path) {
  std::vector<slalom::maps::ReferencePoint> points;
  for (const Waypoint& w : path) points.push_back({w.x, w.y, w.yaw, w.speed});
  hidden_->planner = hidden_->make(hidden_->settings, points);
  hidden_->path = points;
}

bool Planner::has_path() const {
  return hidden_->planner != nullptr;
}
double Planner::control_period() const {
  return hidden_->settings.planner.control_period;
}
Pose Planner::laser() const {
  const auto& o = hidden_->settings.planner;
  return {o.laser_x, o.laser_y, o.laser_yaw};
}

void Planner::save(const std::string& file) const {
  slalom::evaluation::replace_file(file, slalom::vehicle::to_yaml(hidden_->settings));
}

void ImuSamples::add(double yaw_rate, double forward, double leftward) {
  if (!slalom::plausible({yaw_rate, forward, leftward})) return;
  yaw_rate_ += yaw_rate;
  forward_ += forward;
  leftward_ += leftward;
  ++count_;
}

Command Planner::update(const Scan& scan, const Pose& at, double speed, const ImuSamples& imu) {
  hidden_->predicted.clear();
  if (!hidden_->planner) return {.status = "no path"};
  slalom::vehicle::PlannerInput input{.scan = view(scan), .odometry = {.pose = pose(at), .speed = speed}};
  if (imu.count() > 0) input.imu = slalom::ImuReading{imu.yaw_rate(), imu.forward(), imu.leftward()};
  const auto& out = hidden_->planner->update(input);
  for (const auto& state : out.predicted) hidden_->predicted.push_back(plain(state.pose));
  Command command;
  command.status = slalom::vehicle::name(out.status);
  command.update_time = out.tick_time;
  command.friction = out.parameters.friction;
  command.friction_deviation = out.parameters.friction_deviation;
  command.cautious_friction = out.parameters.cautious_friction;
  command.confidence = out.parameters.confidence;
  command.steering_gain = out.parameters.steering_gain;
  command.delay = out.parameters.delay;
  command.yaw_rate = out.yaw_rate_estimate;
  command.slip = out.slip_estimate;
  command.state_cost = out.state_cost;
  command.collision_cost = out.collision_cost;
  for (const float each : out.inputs) command.input_error += std::abs(static_cast<double>(each));
  if (out.solve) command.effective_samples = out.solve->effective_sample_size;
  command.corrections = out.corrections;
  command.steer = out.command.steer;
  command.speed = out.command.speed;
  command.ok = out.status == PlannerStatus::ok || out.status == PlannerStatus::fallback_plan ||
               out.status == PlannerStatus::solver_degenerate;
  return command;
}

const std::vector<Pose>& Planner::predicted() const {
  return hidden_->predicted;
}

}  // namespace slalom_bridge
