#include "vehicle/course/track_parts.hpp"

#include <stdexcept>

namespace slalom::vehicle::detail {
namespace {

using std::numbers::pi;
constexpr double turning_radius = 0.9;  // m, more than the 0.74 m of a 1/10 car at full lock
constexpr double step = 0.1;            // m, of the finished centre line
constexpr int max_draws = 6000;

/// The SplitMix64 generator (Steele, Lea & Flood, OOPSLA 2014): the same numbers on every machine.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : state_(seed) {}
  double uniform(double low, double high) {
    state_ += 0x9E3779B97F4A7C15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    z ^= z >> 31;
    return low + (high - low) * static_cast<double>(z >> 11) * 0x1.0p-53;
  }

 private:
  std::uint64_t state_;
};

/// Corners on a circle, every other one moved inwards, then stretched and twisted; unit size. `calm` in
/// [0, 1] moves the result towards a circle.
Curve draw_polygon(Draw& draw, const Style& style, double length, double calm) {
  const double wanted = length / style.corner_spacing * draw.uniform(0.8, 1.2) * (1 - 0.5 * calm);
  const int corners = std::clamp(saturate_cast<int>(std::round(wanted)), 4, 60);
  const double depth = style.depth * (1 - calm);
  const double stretch = 1 + draw.uniform(0.0, style.stretch - 1) * (1 - calm);
  const double swirl = draw.uniform(-style.swirl, style.swirl) * (1 - calm);
  Curve polygon;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * pi * (i + draw.uniform(-0.35, 0.35) * (1 - calm)) / corners;
    const bool inwards = draw.uniform(0, 1) < (i % 2 == 0 ? 0.15 : 0.75);
    const double radius = inwards ? 1 - draw.uniform(0.4, 1.0) * depth : 1 - draw.uniform(0.0, 0.25) * depth;
    const double turned = angle + swirl * radius;
    polygon.push_back({stretch * radius * std::cos(turned), radius * std::sin(turned)});
  }
  return polygon;
}

/// Appends the arc that rounds the corner at `b` with the given radius, or the largest one that half of the
/// sides allow. Returns the radius; 0 if the corner is too sharp to round.
double round_corner(Curve& path, maps::Point a, maps::Point b, maps::Point c, double radius) {
  const maps::Point in = b - a, out = c - b;
  const double in_length = std::hypot(in.x, in.y), out_length = std::hypot(out.x, out.y);
  const maps::Point u = (1 / in_length) * in, v = (1 / out_length) * out;
  const double turn = std::atan2(cross(u, v), dot(u, v));
  const double half_tangent = std::tan(0.5 * std::abs(turn));
  if (half_tangent < 1e-6) {
    path.push_back(b);
    return radius;
  }
  const double tangent = std::min(radius * half_tangent, 0.49 * std::min(in_length, out_length));
  const double fitted = tangent / half_tangent;
  const maps::Point begin = b - tangent * u;
  const double side = turn > 0 ? 1.0 : -1.0;
  const maps::Point centre = begin + (side * fitted) * maps::Point{-u.y, u.x};
  const int pieces = std::max(2, saturate_cast<int>(std::ceil(std::abs(turn) / 0.1)));
  for (int k = 0; k <= pieces; ++k) {
    const double angle = turn * k / pieces, s = std::sin(angle), cs = std::cos(angle);
    const maps::Point arm = begin - centre;
    path.push_back(centre + maps::Point{cs * arm.x - s * arm.y, s * arm.x + cs * arm.y});
  }
  return fitted;
}

/// Points at small equal steps along straight lines: a rounded polygon.
Curve evenly(const Curve& path, int count) {
  const double spacing = detail::length(path) / count;
  Curve result;
  double left = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const maps::Point d = path[(i + 1) % path.size()] - path[i];
    const double stretch = std::hypot(d.x, d.y);
    for (; left < stretch; left += spacing) result.push_back(path[i] + (left / stretch) * d);
    left -= stretch;
  }
  return result;
}

/// The polygon scaled, rounded and smoothed to the given length; empty if a corner cannot be rounded.
Curve rounded(const Curve& polygon, const std::vector<double>& radii, const TrackGeneratorOptions& options,
              double smoothing) {
  double scale = options.length / detail::length(polygon);
  Curve path;
  for (int round = 0; round < 6; ++round) {
    path.clear();
    const std::size_t n = polygon.size();
    for (std::size_t i = 0; i < n; ++i) {
      const double fitted = round_corner(path, scale * polygon[(i + n - 1) % n], scale * polygon[i],
                                         scale * polygon[(i + 1) % n], radii[i]);
      if (fitted < 0.6 * min_radius(options)) return {};
    }
    scale *= options.length / detail::length(path);
  }
  const int count = saturate_cast<int>(std::round(options.length / step));
  Curve curve = resampled(smoothed(evenly(path, 2 * count), smoothing), count);
  const double stretch = options.length / detail::length(curve);
  for (maps::Point& point : curve) point = stretch * point;
  return curve;
}

bool acceptable(const Curve& curve, const TrackGeneratorOptions& options, double min_winding,
                double max_winding) {
  const double radius = min_radius(options);
  const double spacing = options.length / static_cast<double>(curve.size());
  double turned = 0;  // rad, to either side
  for (const double k : curvature(curve, 2)) {
    if (std::abs(k) > 1 / radius) return false;
    turned += std::abs(k) * spacing;
  }
  const double winds = turned / (2 * pi);
  if (winds < min_winding - 0.01 || winds > max_winding) return false;
  return min_gap(curve, pi * radius) >= options.width + 2 * options.wall;
}

/// Turns the curve about the origin to the least extent in y: its map has the least empty area.
void lay_flat(Curve& curve) {
  double best_height = 0, best_angle = 0;
  for (int k = 0; k < 60; ++k) {
    const double angle = pi * k / 60, s = std::sin(angle), c = std::cos(angle);
    double low = 0, high = 0;
    for (const maps::Point& p : curve) {
      low = std::min(low, s * p.x + c * p.y);
      high = std::max(high, s * p.x + c * p.y);
    }
    if (k == 0 || high - low < best_height) {
      best_height = high - low;
      best_angle = angle;
    }
  }
  const double s = std::sin(best_angle), c = std::cos(best_angle);
  for (maps::Point& p : curve) p = {c * p.x - s * p.y, s * p.x + c * p.y};
}

}  // namespace

const Style& style_of(TrackCharacter character) noexcept {
  static constexpr Style styles[] = {
      {"balanced", 6.0, 2.2, 7.0, 0.60, 1.8, 0.7, 1.3, 4.5, 0.6, 1.4, 2.6},
      {"fast", 7.0, 2.6, 11.0, 0.35, 2.0, 0.3, 3.0, 9.0, 1.2, 1.15, 1.6},
      {"twisty", 5.0, 2.2, 4.3, 0.74, 1.7, 1.1, 1.1, 2.0, 0.45, 2.6, 9.0},
      {"narrow", 4.5, 1.5, 6.0, 0.60, 1.6, 0.8, 1.2, 3.5, 0.55, 1.6, 4.0},
  };
  return styles[static_cast<int>(character)];
}

double min_radius(const TrackGeneratorOptions& options) {
  const double half = 0.5 * options.width;
  return std::max(half + options.wall, half - options.wall_margin + turning_radius);
}

Curve make_centre_line(const TrackGeneratorOptions& options) {
  const Style& style = style_of(options.character);
  Draw draw(options.seed);
  const double small = std::max(style.small_radius, 1.1 * min_radius(options));
  const double large = std::max(style.large_radius, 1.5 * small);
  for (int i = 0; i < max_draws; ++i) {
    // After failed candidates (short or wide tracks) the next ones are closer to a circle.
    const double calm = std::max(0.0, 2.0 * i / max_draws - 1);
    const Curve polygon = draw_polygon(draw, style, options.length, calm);
    std::vector<double> radii;
    for (std::size_t k = 0; k < polygon.size(); ++k) radii.push_back(draw.uniform(small, large));
    const bool backwards = draw.uniform(0, 1) < 0.5;
    Curve curve = rounded(polygon, radii, options, style.smoothing * (1 - 0.5 * calm));
    const double min_winding = 1 + (style.min_winding - 1) * std::max(0.0, 1 - 4.0 * i / max_draws);
    if (curve.empty() ||
        !acceptable(curve, options, min_winding, style.max_winding * std::max(1.0, options.length / 60)))
      continue;
    if (backwards) std::reverse(curve.begin(), curve.end());
    lay_flat(curve);
    return curve;
  }
  throw std::invalid_argument("length: no track of " + std::to_string(options.length) +
                              " m was found for a width of " + std::to_string(options.width) +
                              " m; use a greater length or a smaller width");
}

}  // namespace slalom::vehicle::detail
