#include "slalom/vehicle/model/obstacle_cost.hpp"

#include <cmath>

namespace slalom::vehicle {

namespace {

/// The radius of three equal discs that cover the body's rectangle, m.
double disc_radius(const BodyOptions& options) {
  return std::hypot((options.front + options.rear) / 6, options.width / 2);
}

}  // namespace

ObstacleCost::ObstacleCost(const BodyOptions& options)
    : discs_(options.model == BodyModel::discs),
      radius_(disc_radius(options)),
      margin_(options.margin),
      soft_margin_(options.soft_margin) {
  const double length = options.front + options.rear;
  for (int i = 0; i < 3; ++i) disc_[i] = -options.rear + length * (2 * i + 1) / 6;
  set_margin_shares(1, 1);
  soft_cost_ = options.soft_margin > 0 ? options.soft_cost : 0;
}

void ObstacleCost::set_margin_shares(double margin, double soft) noexcept {
  collision_clearance_ = radius_ + margin * margin_;
  soft_end_ = radius_ + margin * margin_ + soft * soft_margin_;
  inverse_soft_margin_ = soft_margin_ > 0 ? 1 / (soft * soft_margin_) : 0;
}

double ObstacleCost::clearance_reach(const BodyOptions& options) {
  return disc_radius(options) + options.margin + options.soft_margin + 0.01;
}

void ObstacleCost::set_map(const GridView<1>& obstacles, const maps::Pose& robot) noexcept {
  obstacles_ = obstacles;
  robot_ = robot;
  const double c = std::cos(robot.yaw), s = std::sin(robot.yaw);
  to_local_[0] = c;
  to_local_[1] = s;
  to_local_[2] = -c * robot.x - s * robot.y;
  to_local_[3] = -s;
  to_local_[4] = c;
  to_local_[5] = s * robot.x - c * robot.y;
  for (int i = 0; i < 6; ++i) {
    const GridAxis& axis = i < 3 ? obstacles.rows_axis() : obstacles.columns_axis();
    to_cells_[i] = to_local_[i] * axis.scale + (i % 3 == 2 ? axis.offset : 0);
  }
}

}  // namespace slalom::vehicle
