// The conversion of a control step to Foxglove messages.

#include "view/recording/recorder.hpp"

namespace slalom::view {
namespace {

using foxglove::Color;

constexpr Color car_color{0.95, 0.96, 0.98, 1}, ghost_color{0.78, 0.61, 1, 0.7},
    plan_color{0.1, 0.8, 0.65, 1}, nominal_color{0.6, 0.65, 0.7, 0.9}, obstacle_color{0.91, 0.63, 0.23, 1},
    hit_color{1, 0.35, 0.21, 1};
constexpr double car_height = 0.15, obstacle_height = 0.25;  // m

}  // namespace

void Recorder::add_scene(const FrameReader& reader) {
  add_scan(reader);
  add_cars(reader);
  add_plan(reader);
}

void Recorder::add_scan(const FrameReader& reader) {
  const std::string_view block = reader.block(Block::scan);
  if (block.empty()) return;
  PayloadReader payload(block);
  const maps::Pose sensor = payload.pose();
  std::vector<std::uint16_t> ranges(payload.get<std::uint32_t>());
  for (auto& each : ranges) each = payload.get<std::uint16_t>();
  add(Topic::transform, foxglove::frame_transform(time_, "lidar", sensor));
  add(Topic::scan,
      foxglove::laser_scan(time_, "lidar", options_.lidar_angle_min, options_.lidar_angle_increment, ranges));
}

void Recorder::add_cars(const FrameReader& reader) {
  foxglove::Scene scene(time_);
  PayloadReader bodies(reader.block(Block::bodies));
  const auto count = bodies.get<std::uint32_t>();
  scene.begin("bodies");
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto id = bodies.get<std::uint16_t>();
    const auto kind = bodies.get<std::uint8_t>();
    const bool collided = bodies.get<std::uint8_t>() != 0;
    const double x = bodies.f32(), y = bodies.f32(), yaw = bodies.f32(), length = bodies.f32();
    const double width = bodies.f32();
    const maps::Pose pose{x, y, yaw};
    if (id == 0) add(Topic::transform, foxglove::frame_transform(time_, "car", pose));
    constexpr int disc = 3;
    if (kind == disc)
      scene.disc({x, y}, length, obstacle_height, collided ? hit_color : obstacle_color);
    else
      scene.box(pose, length, width, id == 0 ? car_height : obstacle_height,
                collided  ? hit_color
                : id == 0 ? car_color
                          : obstacle_color);
  }
  scene.begin("predictions");
  if (const auto block = reader.block(Block::others); !block.empty()) {
    PayloadReader others(block);
    for (auto left = others.get<std::uint32_t>(); left > 0; --left) {
      others.take(3 * sizeof(float));
      const std::size_t hypotheses = others.get<std::uint16_t>(), times = others.get<std::uint16_t>();
      std::vector<double> weights(hypotheses);
      for (double& weight : weights) weight = others.f32();
      const auto places = others.points(hypotheses * times);
      for (std::size_t k = 0; k < hypotheses; ++k) {
        Color color = obstacle_color;
        color[3] = weights[k];
        scene.line(std::span(places).subspan(k * times, times), color, 2);
      }
    }
  }
  scene.begin("ghost");
  if (const auto block = reader.block(Block::ghost_frame); !block.empty()) {
    const FrameReader ghost(block);
    PayloadReader scalars(ghost.block(Block::scalars));
    scalars.take(2 * sizeof(double));  // tick and time
    const maps::Pose pose = scalars.pose();
    scene.box(pose, 0.5, 0.27, car_height, ghost_color);
    scene.text({pose.x, pose.y}, 0.4, "ghost", ghost_color);
    std::vector<maps::Point> plan;
    for (const auto& state : plan_of(ghost)) plan.push_back({state[0], state[1]});
    scene.line(plan, ghost_color, 2);
  }
  add(Topic::cars, scene.message());
}

void Recorder::add_plan(const FrameReader& reader) {
  foxglove::Scene scene(time_);
  scene.begin("plan");
  std::vector<maps::Point> middle, left, right;
  for (const auto& [x, y, yaw, speed, steer, spread] : plan_of(reader)) {
    const double u = -2 * spread * std::sin(yaw), v = 2 * spread * std::cos(yaw);  // two standard deviations
    middle.push_back({x, y});
    left.push_back({x + u, y + v});
    right.push_back({x - u, y - v});
  }
  if (!middle.empty()) {
    scene.line(middle, plan_color, 4);
    const Color edge{plan_color[0], plan_color[1], plan_color[2], 0.4};
    scene.line(left, edge, 1);
    scene.line(right, edge, 1);
  }
  if (const auto block = reader.block(Block::nominal); !block.empty()) {
    PayloadReader payload(block);
    const auto count = payload.get<std::uint32_t>();
    scene.line(payload.points(count), nominal_color, 2);
  }
  add(Topic::plan, scene.message());
}

}  // namespace slalom::view
