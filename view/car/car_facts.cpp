
#include "view/car/car_subject.hpp"
#include "view/protocol/frame_writer.hpp"

namespace slalom::view {
namespace {

constexpr const char* figure_labels =
    "speed steer yaw_rate slip command_steer command_speed steer_estimate draw_ms evaluate_ms guide_ms "
    "update_ms solve_ms lap lap_time progress path_distance clearance sequence_cost slip_estimate grip_used "
    "friction_estimate friction_relied_on steering_gain_estimate steering_offset_estimate delay_estimate "
    "odometry_x odometry_y odometry_yaw odometry_speed";

}  // namespace

std::shared_ptr<const SubjectFacts> car_facts(const evaluation::Environment* environment) {
  SubjectFacts facts{.inputs = {"steering, rad", "acceleration, m/s^2"},
                     .terms = {"distance", "yaw", "collision"}};
  facts.can_place = facts.can_move = facts.can_add = facts.can_delay = true;
  facts.fixes_seed = facts.scans_ahead = true;
  for (int i = 0; i <= static_cast<int>(vehicle::PlannerStatus::solver_degenerate); ++i)
    facts.statuses.emplace_back(name(static_cast<vehicle::PlannerStatus>(i)));
  facts.figures = words_of(figure_labels);
  facts.speed = 3;
  facts.steering = 4;
  if (!environment) return std::make_shared<const SubjectFacts>(std::move(facts));
  const sim::WorldOptions world = environment->world_options();
  facts.title = environment->course.name;
  facts.length = world.car.length;
  facts.width = world.car.width;
  facts.front = world.car.front_length;
  facts.rear = world.car.rear_length;
  facts.scanner = {world.lidar.angle_min(), world.lidar.angle_increment(), world.lidar.range_max};
  facts.map = environment->course.map;
  facts.course = environment->path;
  facts.is_closed = environment->course.closed;
  return std::make_shared<const SubjectFacts>(std::move(facts));
}

const std::vector<std::string>& car_scalars() {
  static const std::vector<std::string> names = scalar_names(*car_facts());
  return names;
}

ScenarioNames with_course(ScenarioNames names, const evaluation::Environment& environment) {
  names.description = environment.course.description;
  names.evaluation = evaluation::name(environment.protocol);
  names.length = environment.course.length;
  return names;
}

std::vector<OptionSection> sections_of(const vehicle::Configuration& configuration,
                                       const std::string& method) {
  std::vector<OptionSection> sections;
  for (auto& [name, options] : vehicle::list_sections(configuration)) {
    const auto place = name == method ? sections.begin() : sections.end();
    sections.insert(place, {name, std::move(options)});
  }
  return sections;
}

}  // namespace slalom::view
