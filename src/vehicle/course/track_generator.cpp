#include "slalom/vehicle/course/track_generator.hpp"

#include "slalom/vehicle/course/raceline.hpp"
#include "vehicle/course/track_parts.hpp"
#include "vehicle/require.hpp"

namespace slalom::vehicle {
namespace {

using namespace detail;  // curves, and the operators of points

constexpr double program_step = 0.25;   // m between the points of the raceline's quadratic program
constexpr double raceline_step = 0.11;  // m
constexpr int curvature_reach = 3;      // rows, reduces the noise of second differences
constexpr double border = 0.3;          // m of unknown cells around the walls

Curve make_raceline(const Curve& centre_line, const TrackGeneratorOptions& options) {
  // A multiple of 16 halves evenly down to the coarsest level.
  const int count = 16 * saturate_cast<int>(std::ceil(options.length / program_step / 16));
  Curve line = detail::resampled(centre_line, count);
  const auto offsets = minimum_curvature_offsets(line, 0.5 * options.width - options.wall_margin);
  const Curve normals = detail::normals(line);
  for (int i = 0; i < count; ++i) line[i] = line[i] + offsets[i] * normals[i];
  return detail::resampled(line, saturate_cast<int>(std::floor(detail::length(line) / raceline_step)));
}

std::vector<RacelinePoint> with_profile(Curve& line, const SpeedLimits& limits, double& lap_time) {
  const std::size_t n = line.size();
  const double step = detail::length(line) / static_cast<double>(n);
  auto curvature = detail::curvature(line, curvature_reach);
  auto speed = feasible_speeds(std::vector<double>(n, limits.top_speed), curvature,
                               std::vector<double>(n, step), true, limits);
  const auto first = static_cast<std::ptrdiff_t>(detail::start_row(speed));
  std::rotate(line.begin(), line.begin() + first, line.end());
  std::rotate(curvature.begin(), curvature.begin() + first, curvature.end());
  std::rotate(speed.begin(), speed.begin() + first, speed.end());
  lap_time = 0;
  std::vector<RacelinePoint> raceline(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = (i + 1) % n;
    const maps::Point at = line[i], ahead = line[next] - line[(i + n - 1) % n];
    const double arc = static_cast<double>(i) * step, yaw = std::atan2(ahead.y, ahead.x);
    const double acceleration = (speed[next] * speed[next] - speed[i] * speed[i]) / (2 * step);
    raceline[i] = {arc, at.x, at.y, yaw, curvature[i], speed[i], acceleration};
    lap_time += 2 * step / (speed[i] + speed[next]);
  }
  return raceline;
}

/// The row of a curve that is nearest to a point.
std::size_t nearest_row(const Curve& curve, maps::Point point) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < curve.size(); ++i)
    if (dot(curve[i] - point, curve[i] - point) < dot(curve[best] - point, curve[best] - point)) best = i;
  return best;
}

/// The places of parked cars: along the raceline, moved to one side so that there is room to pass on the
/// other. A parked car has any heading, is up to 0.1 m off this path, and reaches 0.33 m from its centre.
std::vector<maps::Point> make_obstacle_path(const Curve& centre_line, const Curve& line,
                                            const TrackGeneratorOptions& options) {
  constexpr double reach = 0.43, room = 1.0, off_wall = 0.25, switch_over = 0.1;  // m
  const double half = 0.5 * options.width;
  const double least = std::clamp(room + reach - half, 0.0, half - off_wall);
  const Curve normals = detail::normals(centre_line);
  std::vector<maps::Point> path;
  double side = 1;
  for (std::size_t i = 0; i < centre_line.size(); ++i) {
    const double offset = dot(line[nearest_row(line, centre_line[i])] - centre_line[i], normals[i]);
    if (std::abs(offset) > switch_over) side = offset > 0 ? 1 : -1;
    path.push_back(centre_line[i] + (side * std::max(side * offset, least)) * normals[i]);
  }
  return path;
}

double squared_distance(maps::Point p, maps::Point a, maps::Point b) {
  const maps::Point along = b - a;
  const double t = std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
  const maps::Point d = p - (a + t * along);
  return dot(d, d);
}

/// The map of a track: cells are free up to half the width from the centre line, occupied in the wall beyond,
/// unknown elsewhere. Cell borders lie on multiples of the resolution.
maps::OccupancyGrid draw_map(const Curve& centre_line, const TrackGeneratorOptions& options) {
  const double half = 0.5 * options.width, reach = half + options.wall, resolution = options.resolution;
  const double inf = std::numeric_limits<double>::infinity();
  maps::Point low{inf, inf}, high{-inf, -inf};
  for (const maps::Point& p : centre_line) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const auto cells_below = [&](double v) { return std::floor((v - reach - border) / resolution); };
  const double left = cells_below(low.x), bottom = cells_below(low.y);
  maps::OccupancyGrid grid;
  grid.resolution = resolution;
  grid.origin = {left * resolution, bottom * resolution, 0};
  grid.width = saturate_cast<int>(std::ceil((high.x + reach + border) / resolution) - left);
  grid.height = saturate_cast<int>(std::ceil((high.y + reach + border) / resolution) - bottom);

  std::vector<double> squared(static_cast<std::size_t>(grid.width) * grid.height, inf);
  for (std::size_t i = 0; i < centre_line.size(); ++i) {
    const maps::Point a = centre_line[i], b = centre_line[(i + 1) % centre_line.size()];
    const auto index = [&](double v, double first) {
      return saturate_cast<int>(std::floor(v / resolution) - first);
    };
    const int x0 = index(std::min(a.x, b.x) - reach, left), x1 = index(std::max(a.x, b.x) + reach, left);
    const int y0 = index(std::min(a.y, b.y) - reach, bottom), y1 = index(std::max(a.y, b.y) + reach, bottom);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const maps::Point centre{(left + x + 0.5) * resolution, (bottom + y + 0.5) * resolution};
        double& least = squared[static_cast<std::size_t>(y) * grid.width + x];
        least = std::min(least, squared_distance(centre, a, b));
      }
  }
  grid.cells.resize(squared.size());
  for (std::size_t i = 0; i < squared.size(); ++i) {
    const double distance = std::sqrt(squared[i]);
    grid.cells[i] = distance <= half    ? maps::Occupancy::free
                    : distance <= reach ? maps::Occupancy::occupied
                                        : maps::Occupancy::unknown;
  }
  return grid;
}

}  // namespace

std::size_t detail::start_row(const std::vector<double>& speed) {
  const std::size_t n = speed.size();
  const double fast = 0.97 * *std::max_element(speed.begin(), speed.end());
  std::size_t best = 0, best_run = 0, run = 0;
  for (std::size_t i = 0; i < 2 * n; ++i) {
    run = speed[i % n] >= fast ? std::min(run + 1, n) : 0;
    if (run > best_run) {
      best_run = run;
      best = (i + n - run / 2) % n;
    }
  }
  return best;
}

const char* name(TrackCharacter character) noexcept {
  return detail::style_of(character).name;
}

TrackCharacter track_character(const std::string& text) {
  for (const auto character :
       {TrackCharacter::balanced, TrackCharacter::fast, TrackCharacter::twisty, TrackCharacter::narrow})
    if (text == detail::style_of(character).name) return character;
  throw std::invalid_argument("character: '" + text + "' must be balanced, fast, twisty or narrow");
}

double usual_top_speed(TrackCharacter character) noexcept {
  return detail::style_of(character).top_speed;
}

double usual_width(TrackCharacter character) noexcept {
  return detail::style_of(character).width;
}

void validate(const TrackGeneratorOptions& options) {
  using detail::require;
  const auto within = [](double v, double low, double high) { return v >= low && v <= high; };
  require(within(options.length, 20, 1000), "length", options.length, "within 20 and 1000 m");
  require(within(options.width, 1.2, 10), "width", options.width, "within 1.2 and 10 m");
  require(within(options.wall, 0.1, 1), "wall", options.wall, "within 0.1 and 1 m");
  require(within(options.resolution, 0.02, 0.1), "resolution", options.resolution, "within 0.02 and 0.1 m");
  require(options.wall >= 2 * options.resolution, "wall", options.wall, "at least 2 cells of the map thick");
  require(within(options.wall_margin, 0.3, 0.5 * options.width - 0.1), "wall_margin", options.wall_margin,
          "at least 0.3 m and leave 0.1 m to either side of the centre line");
  require(options.length >= 16 * (0.5 * options.width + options.wall), "length", options.length,
          "at least 16 (width / 2 + wall); a shorter track cannot be closed");
  require(within(options.limits.top_speed, 0.5, 20), "top_speed", options.limits.top_speed,
          "within 0.5 and 20 m/s");
  const auto acceleration = [&](const char* key, double value) {
    require(within(value, 0.5, 15), key, value, "within 0.5 and 15 m/s^2");
  };
  acceleration("lateral_acceleration", options.limits.lateral_acceleration);
  acceleration("acceleration", options.limits.acceleration);
  acceleration("braking", options.limits.braking);
}

double path_length(const GeneratedTrack& track) {
  const double last = track.raceline.back().arc_length;
  return last + last / static_cast<double>(track.raceline.size() - 1);
}

GeneratedTrack generate_track(const TrackGeneratorOptions& options) {
  validate(options);
  GeneratedTrack track{.options = options};
  Curve centre_line = detail::make_centre_line(options);
  Curve line = make_raceline(centre_line, options);
  track.raceline = with_profile(line, options.limits, track.lap_time);

  const maps::Point start = line.front();
  for (RacelinePoint& point : track.raceline) {
    point.x -= start.x;
    point.y -= start.y;
  }
  for (maps::Point& point : line) point = point - start;
  for (maps::Point& point : centre_line) point = point - start;
  const auto first = static_cast<std::ptrdiff_t>(nearest_row(centre_line, {0, 0}));
  std::rotate(centre_line.begin(), centre_line.begin() + first, centre_line.end());
  track.obstacle_path = make_obstacle_path(centre_line, line, options);
  track.map = draw_map(centre_line, options);
  track.centre_line = std::move(centre_line);
  return track;
}

}  // namespace slalom::vehicle
