#include "slalom/maps/moving_obstacles.hpp"

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/maps/pose_limits.hpp"

namespace slalom::maps {
namespace {

/// The line through two poses: at `a` for t = 0, at `b` for t = 1, and on beyond.
PredictedPose between(const PredictedPose& a, const PredictedPose& b, double t) noexcept {
  const auto mix = [t](double from, double to) { return from + t * (to - from); };
  return {{mix(a.pose.x, b.pose.x), mix(a.pose.y, b.pose.y),
           a.pose.yaw + std::min(t, 1.0) * wrap_angle(b.pose.yaw - a.pose.yaw)},
          mix(a.along_deviation, b.along_deviation),
          mix(a.across_deviation, b.across_deviation)};
}

bool usable(const PredictedObstacle& obstacle) noexcept {
  bool finite = std::isfinite(obstacle.length) && std::isfinite(obstacle.width) && obstacle.interval > 0 &&
                obstacle.hypotheses > 0 && obstacle.hypotheses <= PredictedObstacle::max_hypotheses &&
                !obstacle.poses.empty() &&
                obstacle.poses.size() % static_cast<std::size_t>(obstacle.hypotheses) == 0;
  for (const double weight : obstacle.weights) finite = finite && std::isfinite(weight);
  for (const PredictedPose& each : obstacle.poses) {
    finite = finite && is_plausible(each.pose) && std::isfinite(each.along_deviation) &&
             std::isfinite(each.across_deviation);
  }
  return finite;
}

}  // namespace

int PredictedObstacle::likeliest() const noexcept {
  return static_cast<int>(std::max_element(weights.begin(), weights.begin() + hypotheses) - weights.begin());
}

PredictedPose PredictedObstacle::at(int hypothesis, double time) const noexcept {
  const std::size_t count = times();
  const std::span<const PredictedPose> own =
      poses.subspan(static_cast<std::size_t>(hypothesis) * count, count);
  if (count == 1) return own.front();
  const double place = std::max(time / interval, 0.0);
  const std::size_t before = std::min(saturate_cast<std::size_t>(std::min(place, 1e6)), count - 2);
  return between(own[before], own[before + 1], place - static_cast<double>(before));
}

MovingObstacles::MovingObstacles(const MovingObstacleOptions& options, int steps)
    : options_(options), steps_(steps) {
  validate_options(options, "moving_obstacles");
  if (steps < 1)
    throw std::invalid_argument("moving_obstacles: steps: " + std::to_string(steps) + " must be >= 1");
  const auto times = static_cast<std::size_t>(steps) + 1;
  boxes_.resize(times * max_count * PredictedObstacle::max_hypotheses);
  reaches_.resize(times * max_count);
  followed_.resize(max_count);
  view_.steps_ = steps;
  view_.lead_ = 0.5 * (options.front - options.rear);
  view_.half_length_ = 0.5 * (options.front + options.rear) + options.margin;
  view_.half_width_ = 0.5 * options.width + options.margin;
  // Without a soft margin a box costs nothing outside: the smallest distance is far away.
  view_.inverse_soft_margin_ = 1 / std::max(options.soft_margin, 1e-9);
  view_.soft_cost_ = options.soft_cost;
  view_.collision_cost_ = options.collision_cost;
  view_.max_probability_ = options.max_probability;
}

void MovingObstacles::update(std::span<const PredictedObstacle> predicted, const Point& origin, double first,
                             double time_step) noexcept {
  const auto distance = [&](const PredictedObstacle* each) {
    const Pose& now = each->poses.front().pose;
    return std::hypot(now.x - origin.x, now.y - origin.y);
  };
  int count = 0;
  for (const PredictedObstacle& each : predicted) {
    if (!usable(each)) continue;
    if (count < max_count) {
      taken_[count++] = &each;
      continue;
    }
    const auto farthest = std::max_element(taken_.begin(), taken_.end(), [&](const auto* a, const auto* b) {
      return distance(a) < distance(b);
    });
    if (distance(&each) < distance(*farthest)) *farthest = &each;
  }
  origin_ = origin;
  count_ = 0;
  for (int k = 0; k <= steps_; ++k)
    for (int i = 0; i < count; ++i) place(*taken_[i], first + k * time_step, reaches_[k * count + i]);
  view_.obstacles_ = count;
  view_.followed_ = 0;
  view_.x_ = -origin.x;
  view_.y_ = -origin.y;
}

MovingObstaclesView MovingObstacles::view() const noexcept {
  MovingObstaclesView made = view_;
  made.boxes_ = boxes_.data();
  made.reaches_ = reaches_.data();
  made.followed_at_ = followed_.data();
  return made;
}

void MovingObstacles::set_following_costs(std::span<const double> costs) noexcept {
  const std::size_t count = std::min(costs.size(), taken().size());
  view_.followed_ = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const MovingObstaclesView::Reach& reach = reaches_[static_cast<std::size_t>(steps_) * taken().size() + i];
    const auto& box = boxes_[reach.first + taken_[i]->likeliest()];
    // Skips boxes that are far away by then or whose angle has no sine.
    const bool near = std::hypot(box.x, box.y) < 1e6F && std::isfinite(box.sine + box.cosine);
    if (!(costs[i] > 0) || !near) continue;
    followed_[view_.followed_++] = {box.x, box.y, box.sine, box.cosine, static_cast<float>(costs[i])};
  }
}

/// Writes the boxes of an obstacle at a time, and the circle round them.
void MovingObstacles::place(const PredictedObstacle& obstacle, double time,
                            MovingObstaclesView::Reach& reach) noexcept {
  reach.first = count_;
  double min_x = 1e30, max_x = -1e30, min_y = 1e30, max_y = -1e30, largest = 0;
  for (int h = 0; h < obstacle.hypotheses; ++h) {
    const PredictedPose at = obstacle.at(h, time);
    const double x = at.pose.x - origin_.x, y = at.pose.y - origin_.y;
    const double half_length = 0.5 * obstacle.length + options_.deviations * at.along_deviation;
    const double half_width = 0.5 * obstacle.width + options_.deviations * at.across_deviation;
    boxes_[count_++] = {static_cast<float>(x),
                        static_cast<float>(y),
                        static_cast<float>(std::sin(at.pose.yaw)),
                        static_cast<float>(std::cos(at.pose.yaw)),
                        static_cast<float>(half_length),
                        static_cast<float>(half_width),
                        static_cast<float>(obstacle.weights[h])};
    min_x = std::min(min_x, x);
    max_x = std::max(max_x, x);
    min_y = std::min(min_y, y);
    max_y = std::max(max_y, y);
    largest = std::max(largest, std::hypot(half_length, half_width));
  }
  reach.end = count_;
  reach.x = static_cast<float>(0.5 * (min_x + max_x));
  reach.y = static_cast<float>(0.5 * (min_y + max_y));
  const double own = std::hypot(double(view_.half_length_), double(view_.half_width_)) + options_.soft_margin;
  const double radius = 0.5 * std::hypot(max_x - min_x, max_y - min_y) + largest + own + 1e-3;
  reach.squared = static_cast<float>(radius * radius);
}

void drop_readings_of(const PredictedObstacle& obstacle, double margin, const Pose& sensor,
                      const LaserScanView& scan, std::span<float> ranges) noexcept {
  // Beams further apart than half a turn are no scan; a loop over their turns would hardly end.
  const bool turns_left = scan.angle_increment > 0 && scan.angle_increment < std::numbers::pi;
  if (obstacle.poses.empty() || !turns_left) return;
  const Pose& box = obstacle.poses.front().pose;
  const double half_length = 0.5 * obstacle.length + margin, half_width = 0.5 * obstacle.width + margin;
  const double distance = std::hypot(box.x - sensor.x, box.y - sensor.y),
               radius = std::hypot(half_length, half_width);
  const double bearing = std::atan2(box.y - sensor.y, box.x - sensor.x) - sensor.yaw;
  const double reach = distance > radius ? std::asin(radius / distance) : std::numbers::pi;
  const double first = (wrap_angle(bearing - scan.angle_min - reach)) / scan.angle_increment;
  if (!std::isfinite(first)) return;
  const double turn = 2 * std::numbers::pi / scan.angle_increment;
  // Beams may cover more than a turn, and angles are known up to whole turns.
  for (double begin = first - turn; begin < static_cast<double>(ranges.size()); begin += turn) {
    const double end =
        std::min(begin + 2 * reach / scan.angle_increment + 1, static_cast<double>(ranges.size()));
    for (double beam = std::max(std::floor(begin), 0.0); beam < end; ++beam) {
      float& range = ranges[saturate_cast<std::size_t>(beam)];
      const double angle = sensor.yaw + scan.angle_min + beam * scan.angle_increment;
      const Point point = inverse_transform(box, {sensor.x + static_cast<double>(range) * std::cos(angle),
                                                  sensor.y + static_cast<double>(range) * std::sin(angle)});
      if (std::abs(point.x) <= half_length && std::abs(point.y) <= half_width)
        range = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

}  // namespace slalom::maps
