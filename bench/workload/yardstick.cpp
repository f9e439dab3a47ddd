#include "bench/workload/reference_workload.hpp"

namespace slalom::workload {

Yardstick::Yardstick(const vehicle::PathTrackingOptions& options, const maps::ReferenceField& field,
                     const maps::LocalCostMap& cost_map, const maps::Pose& robot)
    : options_(options),
      held_steps_(static_cast<int>(std::ceil(options.dead_time / options.time_step))),
      cos_(std::cos(robot.yaw)),
      sin_(std::sin(robot.yaw)),
      robot_x_(robot.x),
      robot_y_(robot.y) {
  const auto copy = [](const auto& cells, const maps::GridGeometry& g, int layer) {
    Layer made;
    made.origin_x = g.center_x + 0.5 * g.length_x();
    made.origin_y = g.center_y + 0.5 * g.length_y();
    made.resolution = g.resolution;
    made.rows = g.rows;
    made.columns = g.columns;
    made.outside = cells.at(-1, -1)[layer];
    for (int row = 0; row < g.rows; ++row) {
      for (int column = 0; column < g.columns; ++column) made.values.push_back(cells.at(row, column)[layer]);
    }
    return made;
  };
  distance_ = copy(field.cells(), field.geometry(), 0);
  yaw_ = copy(field.cells(), field.geometry(), 1);
  speed_ = copy(field.cells(), field.geometry(), 2);
  off_map_ = copy(field.cells(), field.geometry(), 3);
  obstacle_ = copy(cost_map.cells(), cost_map.geometry(), 0);
}

double Yardstick::Layer::at(double x, double y) const {
  const double row = (origin_x - x) / resolution, column = (origin_y - y) / resolution;
  if (!(row >= 0 && row < rows && column >= 0 && column < columns)) return static_cast<double>(outside);
  return static_cast<double>(
      values[static_cast<std::size_t>(static_cast<int>(row) * columns + static_cast<int>(column))]);
}

double Yardstick::state_cost(double x, double y, double yaw, double outside) const {
  const double distance = distance_.at(x, y), reference_yaw = yaw_.at(x, y), dx = x - robot_x_,
               dy = y - robot_y_;
  double error = std::atan2(std::sin(yaw - reference_yaw), std::cos(yaw - reference_yaw));
  if (off_map_.at(x, y) > 0) error = reference_yaw;
  double obstacle = obstacle_.at(cos_ * dx + sin_ * dy, cos_ * dy - sin_ * dx);
  if (obstacle < 0) obstacle = outside;
  return options_.cost.distance_weight * distance * distance + options_.cost.yaw_weight * error * error +
         options_.cost.collision_weight * obstacle;
}

double Yardstick::rollout(const CarStart& start, const SequenceBatch& batch, int sample) const {
  const double lf = options_.front_length, lr = options_.rear_length, dt = options_.time_step;
  double x = start.x, y = start.y, yaw = start.yaw, speed = start.speed, steer = start.steer, cost = 0;
  for (int k = 0; k < batch.steps(); ++k) {
    cost += state_cost(x, y, yaw, options_.cost.outside_cost);
    const double next_speed = speed_.at(x, y);
    const double command = static_cast<double>(batch.at(k <= held_steps_ ? 0 : k, 0, sample));
    const double b = std::atan(lf / (lf + lr) * std::tan(steer));
    x += speed * std::cos(yaw + b) * dt;
    y += speed * std::sin(yaw + b) * dt;
    yaw += speed * std::sin(b) / lr * dt;
    yaw = std::atan2(std::sin(yaw), std::cos(yaw));
    steer += (command - steer) / options_.steer_time_constant * dt;
    speed = next_speed;
  }
  return cost + state_cost(x, y, yaw, options_.cost.outside_terminal_cost);
}

void Yardstick::evaluate(const CarStart& start, const SequenceBatch& batch, int count, double* costs) const {
  for (int k = 0; k < count; ++k) costs[k] = rollout(start, batch, k);
}

}  // namespace slalom::workload
