#include "localiser_sensor.hpp"

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::vehicle::detail {
namespace {

/// Log of the probability of a rear axle in a wall or beyond it, per beam: not 0, since maps are not exact.
constexpr float log_in_wall = -1.0F;
/// Standard deviations from a wall within which a beam counts as explained by it.
constexpr double explained_within = 2.5;
/// Readings that end in front of the walls of the map, at something that is not in it, say nothing about the
/// place; but at least this share of all readings counts.
constexpr double least_counted = 0.5;
// Shares of readings from the map, from something in front of it, without a return, and of random ones; rate
// of those in front (1/m): z_hit, z_short, z_max, z_rand and lambda_short.
constexpr double hit_weight = 0.85, short_weight = 0.1, lost_weight = 0.05, random_weight = 0.1;
constexpr double short_rate = 0.5;
constexpr double table_cell = 0.1;  // m, of the table of ranges
constexpr std::size_t max_entries = std::size_t{1} << 27;
/// A change of the expected range by more than this many times the distance across the beam is the edge of an
/// object and not a wall at a small angle to the beam; ranges (m) below the second one count as it.
constexpr double steepest_wall = 8, shortest_lever = 0.05;

maps::GridGeometry geometry_of(const maps::OccupancyGrid& map, double resolution) {
  const double length = map.width * map.resolution, width = map.height * map.resolution;
  const int rows = std::max(1, saturate_cast<int>(std::ceil(length / resolution - 1e-9)));
  const int columns = std::max(1, saturate_cast<int>(std::ceil(width / resolution - 1e-9)));
  return {rows, columns, resolution, 0.5 * rows * resolution, 0.5 * columns * resolution};
}

/// Probability densities of a reading (1/m), as Tables 6.1 and 6.3 mix them.
double hit_density(const LocaliserOptions& o) {
  return hit_weight / (o.hit_deviation * std::sqrt(2 * std::numbers::pi));
}
double random_density(const LocaliserOptions& o) {
  return random_weight / o.range_cap;
}

/// Distance (m, at most `most`) along a direction to the first occupied cell, from a point in cells: steps as
/// long as the distances of the cells allow (sphere tracing, J. C. Hart, The Visual Computer 12, 1996).
double cast(const maps::DistanceField& walls, double x, double y, double dx, double dy, double most) {
  double travelled = 0;  // cells
  const double end = most / walls.resolution;
  while (travelled < end) {
    const int column = saturate_cast<int>(std::floor(x + travelled * dx), -1);
    const int row = saturate_cast<int>(std::floor(y + travelled * dy), -1);
    if (column < 0 || row < 0 || column >= walls.width || row >= walls.height) return most;
    const double clear = walls.at(column, row) / walls.resolution;
    if (clear <= 0) return travelled * walls.resolution;
    travelled += std::max(clear - std::numbers::sqrt2, 0.2);
  }
  return most;
}

}  // namespace

void check_map(const maps::OccupancyGrid& map) {
  maps::check_grid(map);
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("localiser: map: must have ") + what);
  };
  require(map.width <= 32766 && map.height <= 32766, "at most 32766 cells to a side");
  require(std::count(map.cells.begin(), map.cells.end(), maps::Occupancy::free) > 0, "a free cell");
  require(std::count(map.cells.begin(), map.cells.end(), maps::Occupancy::occupied) > 0, "an occupied cell");
}

bool choose_beams(const maps::LaserScanView& scan, const LocaliserOptions& options,
                  ScanBeams& beams) noexcept {
  beams.hits = beams.count = 0;
  const std::size_t readings = scan.ranges.size();
  if (readings == 0 || !std::isfinite(scan.angle_min) || !std::isfinite(scan.angle_increment) ||
      !std::isfinite(scan.range_min) || std::isnan(scan.range_max))
    return false;
  const std::size_t parts = std::min(readings, static_cast<std::size_t>(options.beams));
  const double bins_per_turn = table_angles / (2 * std::numbers::pi);
  const auto add = [&](std::size_t at, double range, std::size_t reading) {
    const double bearing =
        options.laser_yaw + scan.angle_min + static_cast<double>(reading) * scan.angle_increment;
    beams.end_x[at] = static_cast<float>(options.laser_x + range * std::cos(bearing));
    beams.end_y[at] = static_cast<float>(options.laser_y + range * std::sin(bearing));
    beams.range[at] = static_cast<float>(range);
    const double bin = maps::wrap_angle(bearing) * bins_per_turn;
    const double across = bins_per_turn / std::max(range, shortest_lever);
    beams.forward_x[at] = static_cast<float>(std::cos(bearing));
    beams.forward_y[at] = static_cast<float>(std::sin(bearing));
    beams.sideways_x[at] = static_cast<float>(-across * std::sin(bearing));
    beams.sideways_y[at] = static_cast<float>(across * std::cos(bearing));
    beams.steepest[at] = static_cast<float>(steepest_wall / across);
    beams.bin[at] = std::min(static_cast<float>(bin < 0 ? bin + table_angles : bin),
                             static_cast<float>(table_angles - 1e-3));
  };
  const double least = std::max(scan.range_min, 0.0), most = std::min(options.range_cap, scan.range_max);
  std::size_t lost = parts;  // those without return gather at the back
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t begin = part * readings / parts, end = (part + 1) * readings / parts;
    std::size_t missed = end;
    for (std::size_t i = begin + (end - begin) / 2, looked = 0; looked < end - begin; ++looked) {
      const double range = static_cast<double>(scan.ranges[i]);
      if (range > least && range < most) {
        add(beams.hits++, range, i);
        missed = end;
        break;
      }
      if (range >= most && missed == end) missed = i;
      if (++i == end) i = begin;
    }
    if (missed != end) add(--lost, options.range_cap, missed);
  }
  beams.count = beams.hits;
  for (; lost < parts; ++lost, ++beams.count) {
    for (auto* values : {&beams.end_x, &beams.end_y, &beams.range, &beams.bin})
      (*values)[beams.count] = (*values)[lost];
  }
  return beams.hits >= options.min_beams;
}

SensorTables::SensorTables(const maps::OccupancyGrid& map, const LocaliserOptions& options)
    : options_(options),
      geometry_(geometry_of(map, map.resolution)),
      field_(geometry_.rows, geometry_.columns),
      place_(geometry_.rows, geometry_.columns),
      walls_(maps::distance_transform(map, false)) {
  make_field(map, options);
  if (options.sensor_model == SensorModel::beam) make_ranges(map);
}

void SensorTables::make_field(const maps::OccupancyGrid& map, const LocaliserOptions& options) {
  const double hit = hit_density(options), random = random_density(options), most = hit + random;
  const auto log_probability = [&](double distance) {
    const double off = distance / options.hit_deviation;
    return static_cast<float>(std::log((hit * std::exp(-0.5 * off * off) + random) / most));
  };
  explained_from_ = log_probability(explained_within * options.hit_deviation);
  field_.fill({log_probability(1e9)});
  place_.fill({log_in_wall});
  for (int row = 0; row < geometry_.rows; ++row) {
    for (int column = 0; column < geometry_.columns; ++column) {
      const int map_column = geometry_.rows - 1 - row, map_row = geometry_.columns - 1 - column;
      // A wall begins half a cell before the centre of its cells.
      const double distance = std::max(0.0, walls_.at(map_column, map_row) - 0.5 * map.resolution);
      *field_.at(row, column) = log_probability(distance);
      if (map.at(map_column, map_row) == maps::Occupancy::free) *place_.at(row, column) = 0;
    }
  }
}

void SensorTables::make_ranges(const maps::OccupancyGrid& map) {
  table_.geometry = geometry_of(map, std::max(table_cell, map.resolution));
  table_.rows = maps::CellGrid<1>(table_.geometry.rows, table_.geometry.columns);
  table_.range_unit = static_cast<float>(options_.range_cap / 65535);

  const double scale = 1 / map.resolution;
  const auto is_free = [&](double x, double y) {
    const int column = saturate_cast<int>(x * scale), row = saturate_cast<int>(y * scale);
    return map.contains(column, row) && map.at(column, row) == maps::Occupancy::free;
  };
  std::vector<maps::Point> origins{{}};
  for (int row = 0; row < table_.geometry.rows; ++row) {
    for (int column = 0; column < table_.geometry.columns; ++column) {
      const double x = table_.geometry.cell_x(row), y = table_.geometry.cell_y(column);
      if (!is_free(x, y)) continue;
      *table_.rows.at(row, column) = static_cast<float>(origins.size());
      origins.push_back({x, y});
    }
  }
  constexpr std::size_t angles = table_angles;
  if (origins.size() * angles > max_entries) {
    options_.sensor_model = SensorModel::likelihood_field;
    return;
  }
  table_.pairs.assign(origins.size() * angles, 0);
  std::vector<std::uint32_t> ranges(angles);
  for (std::size_t i = 1; i < origins.size(); ++i) {
    for (std::size_t a = 0; a < angles; ++a) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(a) / angles;
      const double range = cast(walls_, origins[i].x * scale, origins[i].y * scale, std::cos(angle),
                                std::sin(angle), options_.range_cap);
      ranges[a] = saturate_cast<std::uint32_t>(std::min(65535.0, range / options_.range_cap * 65535));
    }
    for (std::size_t a = 0; a < angles; ++a)
      table_.pairs[i * angles + a] = ranges[a] | (ranges[(a + 1) % angles] << 16);
  }
}

SensorTables::Explained SensorTables::explain(const maps::Pose& pose, const ScanBeams& beams) const noexcept {
  const GridView<1> field = field_.view(geometry_);
  const maps::Point laser = maps::transform(pose, {options_.laser_x, options_.laser_y});
  const double scale = 1 / walls_.resolution;
  int near = 0, in_front = 0;
  double sum = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(beams.hits); ++k) {
    const maps::Point end = maps::transform(pose, {beams.end_x[k], beams.end_y[k]});
    const float value = look_up(field, static_cast<float>(end.x), static_cast<float>(end.y));
    const double range = static_cast<double>(beams.range[k]);
    const double least = range + explained_within * options_.hit_deviation;
    sum += static_cast<double>(std::exp(value));
    if (value >= explained_from_) {
      ++near;
    } else if (cast(walls_, laser.x * scale, laser.y * scale, (end.x - laser.x) / range,
                    (end.y - laser.y) / range, least) >= least) {
      ++in_front;
    }
  }
  const double all = beams.hits, counted = std::max(all - in_front, least_counted * all);
  return {near / all, near / counted, sum / all};
}

void SensorTables::weigh_by_field(const ParticlePoses& particles, const ScanBeams& beams,
                                  float* log_fit) const noexcept {
  WeighInput in{.particles = particles,
                .beams = &beams,
                .field = field_.view(geometry_),
                .place = place_.view(geometry_),
                .log_fit = log_fit};
  detail::weigh_by_field(in);
}

void SensorTables::weigh(const ParticlePoses& particles, const ScanBeams& beams,
                         float* log_fit) const noexcept {
  if (options_.sensor_model == SensorModel::likelihood_field)
    return weigh_by_field(particles, beams, log_fit);
  WeighInput in{.particles = particles, .beams = &beams, .place = place_.view(geometry_), .log_fit = log_fit};
  const double hit = hit_density(options_), random = random_density(options_), highest = hit + random;
  in.rows = table_.rows.view(table_.geometry);
  in.pairs = table_.pairs.data();
  in.range_unit = table_.range_unit;
  in.laser_x = static_cast<float>(options_.laser_x);
  in.laser_y = static_cast<float>(options_.laser_y);
  in.hit_scale = static_cast<float>(-0.5 / (options_.hit_deviation * options_.hit_deviation));
  in.hit = static_cast<float>(hit / highest);
  in.random = static_cast<float>(random / highest);
  in.short_scale = static_cast<float>(short_weight * short_rate / highest);
  in.short_rate = static_cast<float>(short_rate);
  in.lost = static_cast<float>(std::log(std::max(1e-3, lost_weight)));
  in.nothing_from = static_cast<float>(options_.range_cap - options_.hit_deviation);
  weigh_by_ranges(in);
}

}  // namespace slalom::vehicle::detail
