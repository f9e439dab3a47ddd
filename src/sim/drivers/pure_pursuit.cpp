#include "slalom/sim/pure_pursuit.hpp"

#include <algorithm>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/options.hpp"

namespace slalom::sim {
namespace {

constexpr double wheelbase = 0.3302;                // m
constexpr double reacquire = 10, lost_speed = 0.5;  // m, m/s
constexpr double steer_max = 0.4189;                // rad

}  // namespace

PurePursuit::PurePursuit(std::vector<PathPoint> path, const PurePursuitOptions& options)
    : path_(std::move(path)), options_(options) {
  using slalom::detail::check;
  check("pure pursuit", {"lookahead", "m", "", 1e-9, 1e9}, options.lookahead);
  check("pure pursuit", {"points", "", "", 3}, path_.size());
  for (const PathPoint& p : path_)
    for (const double value : {p.point.x, p.point.y, p.speed})
      check("pure pursuit", {"path", "", "", -1e9, 1e9}, value);
}

PurePursuit::Nearest PurePursuit::nearest(const maps::Point& p) const noexcept {
  Nearest best{0, 0, std::numeric_limits<double>::infinity()};
  const std::size_t segments = options_.gym ? path_.size() - 1 : path_.size();
  for (std::size_t i = 0; i < segments; ++i) {
    const maps::Point a = path_[i].point, b = path_[i + 1 == path_.size() ? 0 : i + 1].point;
    const double dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
    const double t =
        squared > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / squared, 0.0, 1.0) : 0.0;
    const double ex = p.x - (a.x + t * dx), ey = p.y - (a.y + t * dy);
    const double distance = std::sqrt(ex * ex + ey * ey);
    if (distance < best.distance) best = {i, t, distance};
  }
  return best;
}

std::optional<double> PurePursuit::cross_segment(const maps::Point& middle, int row,
                                                 double least) const noexcept {
  const int count = static_cast<int>(path_.size());
  const maps::Point a = path_[(row + count) % count].point;
  maps::Point b = path_[(row + 1 + count) % count].point;
  if (options_.gym) b.x += 1e-6, b.y += 1e-6;
  const double vx = b.x - a.x, vy = b.y - a.y;
  const double qa = vx * vx + vy * vy;
  const double qb = 2 * (vx * (a.x - middle.x) + vy * (a.y - middle.y));
  const double qc = (a.x * a.x + a.y * a.y) + (middle.x * middle.x + middle.y * middle.y) -
                    2 * (a.x * middle.x + a.y * middle.y) - options_.lookahead * options_.lookahead;
  const double discriminant = qb * qb - 4 * qa * qc;
  if (discriminant < 0 || qa == 0) return {};
  const double root = std::sqrt(discriminant);
  const double enter = (-qb - root) / (2 * qa), leave = (-qb + root) / (2 * qa);
  if (options_.gym && enter >= 0 && enter <= 1 && enter >= least) return enter;
  if (leave >= 0 && leave <= 1 && leave >= least) return leave;
  return {};
}

std::optional<PurePursuit::Crossing> PurePursuit::cross_circle(const maps::Point& middle, std::size_t start,
                                                               double along) const noexcept {
  const int first = static_cast<int>(start), count = static_cast<int>(path_.size());
  const int end = options_.gym ? count - 1 : count;
  for (int row = first; row < end; ++row)
    if (const auto t = cross_segment(middle, row, row == first ? along : 0)) return Crossing{row, *t};
  for (int row = options_.gym ? -1 : 0; row < first; ++row)
    if (const auto t = cross_segment(middle, row, 0)) return Crossing{row, *t};
  return {};
}

PurePursuit::Target PurePursuit::target(const maps::Point& position) const noexcept {
  Target target;
  target.nearest = nearest(position);
  const std::size_t count = path_.size(), segment = target.nearest.segment;
  if (target.nearest.distance < options_.lookahead) {
    // The sum may carry to the next row, as a start at (row + 1, 0).
    const double start = segment + target.nearest.along;
    const auto row = std::min(saturate_cast<std::size_t>(start), count - 1);
    const auto crossing = cross_circle(position, row, start - std::floor(start));
    if (!crossing) return target;
    const auto at =
        static_cast<std::size_t>((crossing->row + static_cast<int>(count)) % static_cast<int>(count));
    target.mode = Target::Mode::lookahead;
    target.row = crossing->row;
    target.along = crossing->along;
    target.aim = path_[at];
    if (!options_.gym) {
      const PathPoint &a = path_[at], &b = path_[(at + 1) % count];
      const double t = crossing->along;
      target.aim = {{a.point.x + t * (b.point.x - a.point.x), a.point.y + t * (b.point.y - a.point.y)},
                    a.speed + t * (b.speed - a.speed)};
    }
  } else if (target.nearest.distance < reacquire) {
    target.mode = Target::Mode::reacquire;
    target.row = static_cast<int>(segment);
    target.aim = path_[segment];
  }
  return target;
}

Command PurePursuit::command(const maps::Pose& pose) const noexcept {
  const Target found = target({pose.x, pose.y});
  if (found.mode == Target::Mode::lost) return {0, lost_speed};
  const double dx = found.aim.point.x - pose.x, dy = found.aim.point.y - pose.y;
  const double sideways = -std::sin(pose.yaw) * dx + std::cos(pose.yaw) * dy;
  if (options_.gym) {
    if (std::abs(sideways) < 1e-6) return {0, found.aim.speed};
    const double radius = 1 / (2 * sideways / (options_.lookahead * options_.lookahead));
    return {std::atan(wheelbase / radius), found.aim.speed};
  }
  const double squared = dx * dx + dy * dy;
  const double steer = squared > 0 ? std::atan(wheelbase * 2 * sideways / squared) : 0;
  return {std::clamp(steer, -steer_max, steer_max), found.aim.speed};
}

}  // namespace slalom::sim
