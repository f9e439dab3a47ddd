#include "slalom/sim/shapes.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace slalom::sim {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The way along which a ray lies between two parallel lines at -half and half, cut with [enter, leave].
void clip(double start, double slope, double half, double& enter, double& leave) {
  if (slope == 0) {
    if (std::abs(start) > half) enter = infinity;
    return;
  }
  double t0 = (-half - start) / slope, t1 = (half - start) / slope;
  if (t0 > t1) std::swap(t0, t1);
  enter = std::max(enter, t0);
  leave = std::min(leave, t1);
}

}  // namespace

std::array<maps::Point, 4> corners(const Box& box) noexcept {
  const double c = std::cos(box.pose.yaw), s = std::sin(box.pose.yaw);
  const double l = box.length / 2, w = box.width / 2;
  const auto at = [&](double x, double y) {
    return maps::Point{c * x - s * y + box.pose.x, s * x + c * y + box.pose.y};
  };
  return {at(-l, w), at(-l, -w), at(l, -w), at(l, w)};
}

double signed_gap(const Box& a, const Box& b) noexcept {
  const double dx = b.pose.x - a.pose.x, dy = b.pose.y - a.pose.y;
  const double ca = std::cos(a.pose.yaw), sa = std::sin(a.pose.yaw);
  const double cb = std::cos(b.pose.yaw), sb = std::sin(b.pose.yaw);
  // The angle between them counts only by how much of a side shows along the other's axes.
  const double cosine = std::abs(ca * cb + sa * sb), sine = std::abs(sa * cb - ca * sb);
  const double al = a.length / 2, aw = a.width / 2, bl = b.length / 2, bw = b.width / 2;
  const double gaps[] = {std::abs(dx * ca + dy * sa) - al - (bl * cosine + bw * sine),
                         std::abs(dy * ca - dx * sa) - aw - (bl * sine + bw * cosine),
                         std::abs(dx * cb + dy * sb) - bl - (al * cosine + aw * sine),
                         std::abs(dy * cb - dx * sb) - bw - (al * sine + aw * cosine)};
  return *std::max_element(std::begin(gaps), std::end(gaps));
}

double signed_gap(const Box& a, const Disc& b) noexcept {
  const maps::Point p = maps::inverse_transform(a.pose, b.middle);
  const double dx = std::abs(p.x) - a.length / 2, dy = std::abs(p.y) - a.width / 2;
  const double outside = std::hypot(std::max(dx, 0.0), std::max(dy, 0.0));
  return outside + std::min(std::max(dx, dy), 0.0) - b.radius;
}

double ray_distance(const maps::Point& from, double cosine, double sine, const Box& box) noexcept {
  const double c = std::cos(box.pose.yaw), s = std::sin(box.pose.yaw);
  const double dx = from.x - box.pose.x, dy = from.y - box.pose.y;
  double enter = -infinity, leave = infinity;
  clip(c * dx + s * dy, c * cosine + s * sine, box.length / 2, enter, leave);
  clip(c * dy - s * dx, c * sine - s * cosine, box.width / 2, enter, leave);
  if (enter > leave || leave < 0) return infinity;
  return enter >= 0 ? enter : leave;
}

double ray_distance(const maps::Point& from, double cosine, double sine, const Disc& disc) noexcept {
  const double dx = disc.middle.x - from.x, dy = disc.middle.y - from.y;
  const double along = dx * cosine + dy * sine, across = dy * cosine - dx * sine;
  const double under = disc.radius * disc.radius - across * across;
  if (under < 0) return infinity;
  const double half = std::sqrt(under);
  if (along + half < 0) return infinity;
  return along - half >= 0 ? along - half : along + half;
}

}  // namespace slalom::sim
