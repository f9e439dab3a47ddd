#include "slalom/maps/reference_field.hpp"

#include "maps/validation.hpp"
#include "slalom/maps/pose_limits.hpp"

namespace slalom::maps {
namespace {

double squared_distance(const ReferencePoint& a, const ReferencePoint& b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

}  // namespace

void check_reference_path(std::span<const ReferencePoint> path) {
  detail::require(path.size() >= 3, "reference path: number of points", path.size(), "at least 3");
  detail::require(path.size() <= 10000000, "reference path: number of points", path.size(),
                  "at most 10000000");
  double length = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Pose pose{path[i].x, path[i].y, path[i].yaw};
    const bool is_speed = std::isfinite(path[i].speed) && path[i].speed >= 0;
    if (i > 0) length += std::hypot(pose.x - path[i - 1].x, pose.y - path[i - 1].y);
    if (is_plausible(pose) && is_speed) continue;
    const std::string where = "reference path: point " + std::to_string(i);
    check_pose(where, pose);
    detail::require(is_speed, (where + ": speed").c_str(), path[i].speed, "finite and not negative");
  }
  const double density = static_cast<double>(path.size()) / length;
  detail::require(length >= 0.1, "reference path: length", length, "at least 0.1 m");
  detail::require(density <= 1e4, "reference path: points a metre", density, "at most 10000");
}

ReferenceField::ReferenceField(std::span<const ReferencePoint> path, const ReferenceFieldOptions& options)
    : options_(options),
      geometry_(detail::geometry_of(options, "reference_field")),
      cells_(geometry_.rows, geometry_.columns) {
  detail::require(options.points + options.points_behind <= 250, "reference_field.points_behind",
                  options.points_behind, "at most 250 together with `points`");
  check_reference_path(path);
  path_.reserve(path.size());
  path_x_.reserve(path.size());
  path_y_.reserve(path.size());
  set_path(path);
  const auto sites = static_cast<std::size_t>(options.points + options.points_behind);
  window_.resize(sites);
  sites_.resize(sites);
  envelope_.resize(sites + 1);
  column_y_.resize(geometry_.columns);
  cells_.fill({static_cast<float>(options.outside.distance), static_cast<float>(options.outside.yaw),
               static_cast<float>(options.outside.speed), 1});
  update({path[0].x, path[0].y});
  reset();
}

bool ReferenceField::update(const Pose& robot, double reach, double seconds) noexcept {
  if (!std::isfinite(robot.x + robot.y + robot.yaw)) return false;
  geometry_.center_x = robot.x;
  geometry_.center_y = robot.y;
  nearest_ = place_of(robot);
  is_placed_ = true;
  choose_window();
  make_sites();
  for (int column = 0; column < geometry_.columns; ++column) column_y_[column] = geometry_.cell_y(column);
  reach_ = reach;
  if (seconds > 0) {
    double speed = std::abs(options_.outside.speed);
    for (std::size_t k = 0; k < window_size_; ++k)
      speed = std::max(speed, static_cast<double>(sites_[k].speed));
    reach_ = std::max(reach_, 1 + seconds * speed);
  }
  const double cells = std::clamp(reach_ / geometry_.resolution, 0.0, 1e6);
  const int half = saturate_cast<int>(cells) + 2;
  const int rows = geometry_.rows / 2, columns = geometry_.columns / 2;
  for (int row = std::max(rows - half, 0); row < std::min(rows + half, geometry_.rows); ++row) {
    const int parabolas = build_envelope(geometry_.cell_x(row));
    write_row(row, std::max(columns - half, 0), std::min(columns + half, geometry_.columns), parabolas);
  }
  return true;
}

void ReferenceField::set_speeds(std::span<const double> speeds) noexcept {
  if (speeds.size() != path_.size()) return;
  for (std::size_t i = 0; i < speeds.size(); ++i) path_[i].speed = speeds[i];
}

void ReferenceField::set_curvatures(std::span<const double> curvatures, bool closed) {
  if (curvatures.size() != path_.size()) return;
  curvature_.assign(curvatures.begin(), curvatures.end());
  closed_ = closed;
}

bool ReferenceField::set_path(std::span<const ReferencePoint> path) noexcept {
  if (path.size() < 3 || path.size() > path_.capacity()) return false;
  path_.assign(path.begin(), path.end());
  curvature_.clear();
  path_x_.resize(path.size());
  path_y_.resize(path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    path_x_[i] = path[i].x;
    path_y_[i] = path[i].y;
  }
  reset();
  return true;
}

ReferenceCell ReferenceField::at(double x, double y) const noexcept {
  const int row = geometry_.row(x), column = geometry_.column(y);
  const float* cell = row < 0 || column < 0 ? cells_.data() : cells_.at(row, column);
  return {cell[0], cell[1], cell[2], cell[3]};
}

int ReferenceField::place_of(const Pose& robot) const noexcept {
  const auto squared_to = [&](std::size_t i) {
    const double dx = path_x_[i] - robot.x, dy = path_y_[i] - robot.y;
    return dx * dx + dy * dy;
  };
  const auto turned = [&](std::size_t i) { return robot.yaw - path_[i].yaw; };
  return static_cast<int>(place_on_path(path_.size(), squared_to, turned,
                                        is_placed_ ? static_cast<std::size_t>(nearest_) : path_.size()));
}

void ReferenceField::choose_window() noexcept {
  const int count = static_cast<int>(path_.size());
  const double least = options_.spacing * options_.spacing;
  // One round at most: on a short path the window holds no point twice.
  const auto next = [&](int from, int step, int& left) {
    int i = from;
    while (left > 0) {
      --left;
      i = (i + step + count) % count;
      if (squared_distance(path_[i], path_[from]) >= least) return i;
    }
    return -1;
  };
  int left = count - 1;
  window_size_ = 0;
  for (int i = nearest_; i >= 0;) {
    window_[window_size_++] = i;
    i = window_size_ < static_cast<std::size_t>(options_.points) ? next(i, 1, left) : -1;
  }
  const std::size_t ahead = window_size_;
  for (int i = nearest_; window_size_ < ahead + static_cast<std::size_t>(options_.points_behind);) {
    i = next(i, -1, left);
    if (i < 0) break;
    window_[window_size_++] = i;
  }
  std::reverse(window_.begin() + static_cast<std::ptrdiff_t>(ahead),
               window_.begin() + static_cast<std::ptrdiff_t>(window_size_));
  std::rotate(window_.begin(), window_.begin() + static_cast<std::ptrdiff_t>(ahead),
              window_.begin() + static_cast<std::ptrdiff_t>(window_size_));
}

void ReferenceField::make_sites() noexcept {
  const double first = geometry_.cell_y(0);
  for (std::size_t k = 0; k < window_size_; ++k) {
    const auto i = static_cast<std::size_t>(window_[k]);
    const ReferencePoint& point = path_[i];
    sites_[k] = {point.x, point.y, (first - point.y) / geometry_.resolution, static_cast<float>(point.yaw),
                 static_cast<float>(point.speed)};
    if (curvature_.empty()) continue;
    // The window may skip points; where it ends, the line goes on to the next one of the path.
    const std::size_t n = path_.size();
    const std::size_t before = k > 0 ? static_cast<std::size_t>(window_[k - 1]) : (i + n - 1) % n;
    const std::size_t after = k + 1 < window_size_ ? static_cast<std::size_t>(window_[k + 1]) : (i + 1) % n;
    sites_[k].piece = piece_at(before, i, after);
  }
  std::sort(sites_.begin(), sites_.begin() + static_cast<std::ptrdiff_t>(window_size_),
            [](const Site& a, const Site& b) { return a.u < b.u; });
}

ReferenceField::Piece ReferenceField::piece_at(std::size_t before_point, std::size_t point,
                                               std::size_t after_point) const noexcept {
  const ReferencePoint &before = path_[before_point], &here = path_[point], &after = path_[after_point];
  // An open path has no line before its first point and none after its last one.
  const double way_before = closed_ || point > 0 ? std::sqrt(squared_distance(before, here)) : 0;
  const double way_after = closed_ || point + 1 < path_.size() ? std::sqrt(squared_distance(here, after)) : 0;
  Piece piece{.ahead_x = std::cos(here.yaw),
              .ahead_y = std::sin(here.yaw),
              .curvature = curvature_[point],
              .begin = -0.5 * way_before,
              .end = 0.5 * way_after};
  if (way_before > 0) piece.slope_before = (here.speed - before.speed) / way_before;
  if (way_after > 0) piece.slope_after = (after.speed - here.speed) / way_after;
  return piece;
}

/// The lower envelope, along the row of cells at x, of the squared distances to the sites.
int ReferenceField::build_envelope(double x) noexcept {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double scale = 1 / geometry_.resolution;
  Parabola* const bottom = envelope_.data();
  Parabola* end = bottom;
  for (const Site *site = sites_.data(), *stop = site + window_size_; site != stop; ++site) {
    const double dx = (x - site->x) * scale, height = dx * dx, u = site->u;
    double start = -infinity;
    while (end != bottom) {
      // Two sites in one column give an infinite start of the right sign; coincident ones a NaN, which drops
      // the first.
      const Parabola& last = end[-1];
      start = ((height - last.height) / (u - last.u) + u + last.u) * 0.5;
      if (start > last.start) break;
      --end;
      start = -infinity;
    }
    *end++ = {u, height, start, site};
  }
  return static_cast<int>(end - bottom);
}

void ReferenceField::write_row(int row, int begin, int end, int parabolas) noexcept {
  const double x = geometry_.cell_x(row);
  int column = begin;
  for (int k = 0; k < parabolas && column < end; ++k) {
    const Site& site = *envelope_[k].site;
    const double stop = k + 1 < parabolas ? envelope_[k + 1].start : end;
    if (!(stop >= column)) continue;
    const int last = stop >= end ? end : saturate_cast<int>(stop) + 1;
    const int first = column;
    const double dx = x - site.x;
    const auto dx2 = static_cast<float>(dx * dx);
    float* cell = cells_.at(row, column);
    // In two loops, of which the first runs in packs.
    constexpr int block = 64;
    float distance[block];
    while (column < last) {
      const int here = std::min(block, last - column);
      const double* y = column_y_.data() + column;
      for (int i = 0; i < here; ++i) {
        const auto dy = static_cast<float>(y[i] - site.y);
        distance[i] = std::sqrt(dx2 + dy * dy);
      }
      for (int i = 0; i < here; ++i, cell += 4) {
        cell[0] = distance[i];
        cell[1] = site.yaw;
        cell[2] = site.speed;
        cell[3] = 0;
      }
      column += here;
    }
    if (!curvature_.empty()) interpolate(row, first, last, site);
  }
}

void ReferenceField::interpolate(int row, int begin, int end, const Site& site) noexcept {
  constexpr double least = 0.25;  // least 1 - k d, which is 0 at the centre of the path's curve
  const Piece& piece = site.piece;
  const double x = geometry_.cell_x(row) - site.x;
  float* cell = cells_.at(row, begin);
  for (int column = begin; column < end; ++column, cell += 4) {
    const double y = column_y_[column] - site.y;
    const double ahead = piece.ahead_x * x + piece.ahead_y * y, left = piece.ahead_x * y - piece.ahead_y * x;
    const double beside = std::clamp(1 - piece.curvature * left, least, 1 / least);
    const double arc = std::clamp(ahead / beside, piece.begin, piece.end), beyond = ahead - arc * beside;
    cell[0] = static_cast<float>(std::sqrt(left * left + beyond * beyond));
    cell[1] = site.yaw + static_cast<float>(piece.curvature * arc);
    cell[2] = site.speed + static_cast<float>(arc * (arc < 0 ? piece.slope_before : piece.slope_after));
    cell[3] = static_cast<float>(-1 / beside);
  }
}

}  // namespace slalom::maps
