#include "navigation/others.hpp"

#include "navigation/approach.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/tracking/people.hpp"

namespace slalom::navigation::detail {
namespace {

// s, in which meetings are found, and the robot may wait for those on its way
constexpr double foresight = 5;

/// The box around the footprint, and the costs of plans beside others; with this share of the margins.
maps::MovingObstacleOptions options_of(const Footprint& footprint, const NavigatorOptions& options,
                                       double share) {
  maps::MovingObstacleOptions made;
  made.front = made.rear = made.width = 0;
  for (const maps::Point& vertex : footprint.vertices()) {
    made.front = std::max(made.front, vertex.x);
    made.rear = std::max(made.rear, -vertex.x);
    made.width = std::max(made.width, 2 * std::abs(vertex.y));
  }
  made.margin = share * options.costs.others_margin;
  made.soft_margin = share * options.costs.others_reach;
  made.deviations *= share;
  made.collision_cost = options.costs.collision * options.time_step;
  made.soft_cost = options.costs.others * options.time_step;
  made.max_probability = options.costs.others_probability;
  return made;
}

/// A tracker of anything of about a person's size in cells of this size (m). An edge that flickers by up to
/// four cells is no motion.
tracking::TrackerOptions tracker_options(double resolution) {
  tracking::TrackerOptions options = tracking::people_tracker_options();
  options.free_margin = std::max(2 * options.free_margin, 4 * resolution);
  options.acceleration_deviation *= 0.5;
  options.size_deviation *= 5;
  return options;
}

/// Whether the plan collides up to the pose with this index, unless its first pose does already.
bool collides(const maps::MovingObstaclesView& seen, std::span<const maps::Pose> plan, std::size_t last) {
  const auto meets = [&](std::size_t i) {
    const maps::Pose& at = plan[i];
    return seen.cost<double>(at.x, at.y, std::sin(at.yaw), std::cos(at.yaw), static_cast<int>(i)).collided;
  };
  if (seen.empty() || meets(0)) return false;
  for (std::size_t i = 1; i <= last; ++i)
    if (meets(i)) return true;
  return false;
}

}  // namespace

Others::Others(const Footprint& footprint, const NavigatorOptions& options, std::size_t steps,
               double resolution)
    : time_step_(options.time_step),
      speed_(options.base.max_forward),
      half_width_(footprint.half_width() + options.costs.others_margin),
      body_(options_of(footprint, options, 1)),
      obstacles_(body_, static_cast<int>(steps)),
      bodies_(options_of(footprint, options, 0), static_cast<int>(steps)),
      tracker_(tracker_options(resolution)),
      predictor_(tracking::people_predictor_options()),
      range_(2 * options.look_ahead) {}

void Others::clear() noexcept {
  tracker_.reset();
  predictor_.reset();
  now_ = 0;
}

void Others::update(std::span<const maps::PredictedObstacle> predicted, const maps::Pose& robot,
                    const Costmap& costmap, double elapsed) noexcept {
  now_ += elapsed;
  if (predicted.empty()) predicted = find(robot, costmap);
  obstacles_.update(predicted, position(robot), 0, time_step_);
  bodies_.update(predicted, position(robot), 0, time_step_);
}

/// Follows what moves in the costmaps, as in scans that begin behind the robot: their ends are blind.
std::span<const maps::PredictedObstacle> Others::find(const maps::Pose& robot,
                                                      const Costmap& costmap) noexcept {
  const maps::GridGeometry& cells = costmap.geometry();
  const maps::Pose behind{robot.x, robot.y, robot.yaw + std::numbers::pi};
  const double least = 0.5 * cells.resolution;  // m, of a step along a beam
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    const double angle = behind.yaw + maps::beam_angle(i, ranges_.size()), c = std::cos(angle),
                 s = std::sin(angle);
    double range = 0;
    while (range < range_) {
      const maps::Point at{robot.x + range * c, robot.y + range * s};
      const bool is_off = cells.row(at.x) < 0 || cells.column(at.y) < 0;
      const double room = is_off ? range_ : costmap.distance(at.x, at.y);
      if (room <= 0) break;
      range += std::max(room - 2 * least, least);
    }
    ranges_[i] = static_cast<float>(range);
  }
  const maps::LaserScanView scan{ranges_, 0, maps::beam_angle(1, ranges_.size()), 0, range_};
  const auto& seen = tracker_.update({.scan = scan, .sensor = behind, .stamp = now_});
  return predictor_.update(seen.objects, now_);
}

bool Others::are_near(const maps::Point& robot) const noexcept {
  const auto taken = obstacles_.taken();
  return std::any_of(taken.begin(), taken.end(), [&](const maps::PredictedObstacle* each) {
    const maps::Pose& now = each->poses.front().pose;
    return std::hypot(now.x - robot.x, now.y - robot.y) < foresight * speed_ + body_.front;
  });
}

std::optional<maps::ClosedDisc> Others::meeting(std::span<const maps::Pose> path,
                                                double step) const noexcept {
  std::optional<maps::ClosedDisc> first;
  std::size_t last =
      std::min(path.size(), saturate_cast<std::size_t>(foresight * speed_ / std::max(step, 1e-3)));
  for (const maps::PredictedObstacle* const other : obstacles_.taken()) {
    const int likeliest = other->likeliest();
    const auto pose_at = [&](std::size_t i) { return other->at(likeliest, i * step / speed_).pose; };
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < last; ++i) {
      const maps::Pose at = pose_at(i);
      const double distance = std::hypot(at.x - path[i].x, at.y - path[i].y);
      if (distance >= least) continue;
      least = distance;
      nearest = i;
    }
    const double room = half_width_ + 0.5 * std::max(other->length, other->width);
    // At the first point they are beside each other, and at the last one they have not met yet.
    if (nearest == 0 || nearest + 1 >= last || least >= room) continue;
    const maps::Pose at = pose_at(nearest);
    if (std::abs(std::cos(at.yaw - path[nearest].yaw)) < aligned) continue;
    first = maps::ClosedDisc{{at.x, at.y}, room + body_.margin};  // more, so that a way past is kept
    last = nearest;
  }
  return first;
}

/// Whether the plan comes within the margin of the place where an object is now, or nearer if the robot is
/// there already: people stop at once.
bool Others::comes_close(std::span<const maps::Pose> plan, std::size_t last) const noexcept {
  for (const maps::PredictedObstacle* const other : obstacles_.taken()) {
    const maps::Pose& now = other->poses.front().pose;
    const auto gap = [&](const maps::Pose& robot) {
      const maps::Point at = maps::inverse_transform(robot, {now.x, now.y});
      return std::hypot(at.x - std::clamp(at.x, -body_.rear, body_.front),
                        at.y - std::clamp(at.y, -0.5 * body_.width, 0.5 * body_.width));
    };
    const double least =
        std::min(gap(plan.front()) - least_way, 0.5 * std::max(other->length, other->width) + body_.margin);
    for (std::size_t i = 1; i <= last; ++i)
      if (gap(plan[i]) < least) return true;
  }
  return false;
}

bool Others::meet(std::span<const maps::Pose> plan, std::size_t last) const noexcept {
  return collides(obstacles_.view(), plan, last) || collides(bodies_.view(), plan, last) ||
         comes_close(plan, last);
}

}  // namespace slalom::navigation::detail
