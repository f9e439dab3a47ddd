// The conversion of a control step to Foxglove messages.
#include <algorithm>
#include <cmath>

#include "view/recording/recorder.hpp"

namespace slalom::view {
namespace {

using foxglove::Color;

constexpr std::size_t max_candidates = 40;  // in Foxglove's messages; those of the page have all
constexpr Color car_color{0.95, 0.96, 0.98, 1}, ghost_color{0.78, 0.61, 1, 0.7},
    plan_color{0.1, 0.8, 0.65, 1}, nominal_color{0.6, 0.65, 0.7, 0.9}, guide_color{0.8, 0.35, 0.85, 0.9},
    obstacle_color{0.91, 0.63, 0.23, 1}, hit_color{1, 0.35, 0.21, 1}, collided_color{1, 0.35, 0.21, 0.35};
constexpr double car_height = 0.15, obstacle_height = 0.25;  // m

/// The colour of a cost between the best (0) and the worst (1): yellow, green, blue.
Color cost_color(double share) {
  constexpr double stops[3][3] = {{0.93, 0.89, 0.52}, {0.1, 0.66, 0.62}, {0.16, 0.27, 0.6}};
  const double at = 2 * std::clamp(share, 0.0, 1.0);
  const auto i = at < 1 ? 0u : 1u;
  const double f = at - i;
  Color color{0, 0, 0, 0.8 - 0.3 * share};
  for (std::size_t k = 0; k < 3; ++k) color[k] = (1 - f) * stops[i][k] + f * stops[i + 1][k];
  return color;
}

}  // namespace

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

void Recorder::add_cost_map(const FrameReader& reader) {
  const std::string_view block = reader.block(Block::cost_map);
  if (block.empty()) return;
  PayloadReader payload(block);
  const maps::Pose robot = payload.pose();
  const std::size_t rows = payload.get<std::uint16_t>(), columns = payload.get<std::uint16_t>();
  const double resolution = payload.f32(), centre_x = payload.f32(), centre_y = payload.f32();
  // Cells come with the largest x and y first; a grid's begin with the smallest, x along a row.
  std::string cells(rows * columns, '\0');
  unsigned bits = 0;
  for (std::size_t i = 0; i < rows * columns; ++i) {
    if (i % 8 == 0) bits = payload.get<std::uint8_t>();
    const std::size_t row = i / columns, column = i % columns;
    if (bits >> (i % 8) & 1u) cells[(columns - 1 - column) * rows + (rows - 1 - row)] = 100;
  }
  const double u = centre_x - 0.5 * resolution * static_cast<double>(rows),
               v = centre_y - 0.5 * resolution * static_cast<double>(columns);
  const double c = std::cos(robot.yaw), s = std::sin(robot.yaw);
  add(Topic::cost_map, foxglove::grid(time_, {robot.x + c * u - s * v, robot.y + s * u + c * v, robot.yaw},
                                      static_cast<std::uint32_t>(rows), resolution, "cost", cells));
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

void Recorder::add_candidates(const FrameReader& reader) {
  foxglove::Scene scene(time_);
  scene.begin("candidates");
  if (const auto block = reader.block(Block::candidates); !block.empty()) {
    PayloadReader payload(block);
    const std::size_t count = payload.get<std::uint16_t>(), length = payload.get<std::uint16_t>();
    std::vector<double> costs(count), sorted;
    for (double& cost : costs) {
      payload.take(3 * sizeof(float));
      cost = payload.f32();
      payload.take(sizeof(float));
    }
    const std::string_view collided = payload.take(count);
    payload.align();
    const auto points = payload.points(count * length);
    for (std::size_t i = 0; i < count; ++i)
      if (collided[i] == 0) sorted.push_back(costs[i]);
    std::sort(sorted.begin(), sorted.end());
    const double low = sorted.empty() ? 0 : sorted.front(),
                 high = sorted.empty() ? 1 : std::max(low + 1e-9, sorted[sorted.size() * 9 / 10]);
    const std::size_t shown = std::min(max_candidates, count);
    for (std::size_t k = 0; k < shown; ++k) {
      const std::size_t i = k * count / shown;
      const Color color = collided[i] != 0 ? collided_color : cost_color((costs[i] - low) / (high - low));
      scene.line(std::span(points).subspan(i * length, length), color, 1);
    }
  }
  add(Topic::candidates, scene.message());
}

void Recorder::add_guides(const FrameReader& reader) {
  foxglove::Scene scene(time_);
  scene.begin("guides");
  if (const auto block = reader.block(Block::guides); !block.empty()) {
    PayloadReader payload(block);
    const std::size_t guides = payload.get<std::uint16_t>(), iterations = payload.get<std::uint16_t>();
    const std::size_t length = payload.get<std::uint16_t>();
    payload.get<std::uint16_t>();
    const auto points = payload.points(guides * iterations * length);
    std::vector<maps::Point> ends(iterations);
    for (std::size_t i = 0; i < guides; ++i) {
      for (std::size_t k = 0; k < iterations; ++k) ends[k] = points[(k * guides + i + 1) * length - 1];
      const std::size_t last = ((iterations - 1) * guides + i) * length;
      scene.line(std::span(points).subspan(last, length), guide_color, 2);
      scene.line(ends, {guide_color[0], guide_color[1], guide_color[2], 0.5}, 1);
    }
  }
  add(Topic::guides, scene.message());
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
