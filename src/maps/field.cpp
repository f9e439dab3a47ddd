#include "slalom/maps/field.hpp"

#include "maps/validation.hpp"
#include "slalom/core/dispatch.hpp"
#include "slalom/maps/distance_field.hpp"
#include "slalom/maps/pose_limits.hpp"

namespace slalom::maps {
namespace {

struct EvaluateField {
  template <class F>
  SLALOM_INLINE_CALLS static void one(const Field& field, const float* x, const float* y, float* value,
                                      float* dx, float* dy) {
    const FieldValue<F> at = field.value_and_gradient(F::load(x), F::load(y));
    at.value.store(value);
    if (!dx) return;
    at.dx.store(dx);
    at.dy.store(dy);
  }

  template <class Target>
  SLALOM_KERNEL static void run(const Field& field, const float* x, const float* y, std::size_t count,
                                float* value, float* dx, float* dy) {
    using F = Pack<Target>;
    std::size_t i = 0;
    for (; i + F::lanes <= count; i += F::lanes)
      one<F>(field, x + i, y + i, value + i, dx ? dx + i : nullptr, dx ? dy + i : nullptr);
    const std::size_t rest = count - i;
    if (rest == 0) return;
    float at[5][F::lanes] = {};  // x, y, value, dx, dy of the last, incomplete pack
    std::copy_n(x + i, rest, at[0]);
    std::copy_n(y + i, rest, at[1]);
    one<F>(field, at[0], at[1], at[2], at[3], at[4]);
    std::copy_n(at[2], rest, value + i);
    if (!dx) return;
    std::copy_n(at[3], rest, dx + i);
    std::copy_n(at[4], rest, dy + i);
  }
};

/// The grid with a border of occupied cells.
OccupancyGrid with_border(const OccupancyGrid& grid) {
  const Point corner = transform(grid.origin, {-grid.resolution, -grid.resolution});
  OccupancyGrid wide{
      grid.width + 2, grid.height + 2, grid.resolution, {corner.x, corner.y, grid.origin.yaw}, {}};
  wide.cells.assign(static_cast<std::size_t>(wide.width) * static_cast<std::size_t>(wide.height),
                    Occupancy::occupied);
  for (int row = 0; row < grid.height; ++row)
    for (int column = 0; column < grid.width; ++column) wide.at(column + 1, row + 1) = grid.at(column, row);
  return wide;
}

}  // namespace

void Field::check(const FieldGeometry& geometry) {
  detail::require(geometry.width >= 1, "field.width", geometry.width, "at least 1");
  detail::require(geometry.height >= 1, "field.height", geometry.height, "at least 1");
  const std::int64_t samples = std::int64_t{geometry.width} * geometry.height;
  detail::require(samples <= std::int64_t{1} << 26, "field: number of samples", samples,
                  "at most 2^26; use a coarser resolution");
  detail::require(geometry.resolution > 0 && std::isfinite(geometry.resolution), "field.resolution",
                  geometry.resolution, "finite and above 0");
  check_pose("field.origin", geometry.origin);
}

Field::Field() : Field(FieldGeometry{}, std::vector<double>{0.0}) {}

Field::Field(const FieldGeometry& geometry, std::span<const double> samples) : geometry_(geometry) {
  check(geometry);
  const int width = geometry.width, height = geometry.height;
  const auto at = [&](int row, int column) {
    const auto r = static_cast<std::size_t>(std::clamp(row, 0, height - 1)),
               c = static_cast<std::size_t>(std::clamp(column, 0, width - 1));
    return samples[r * static_cast<std::size_t>(width) + c];
  };
  detail::require(samples.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                  "field: number of samples", samples.size(),
                  (std::to_string(height) + " x " + std::to_string(width)).c_str());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (std::abs(samples[i]) <= std::numeric_limits<float>::max()) continue;
    const std::string where = "field: sample in row " + std::to_string(i / static_cast<std::size_t>(width)) +
                              ", column " + std::to_string(i % static_cast<std::size_t>(width));
    detail::require(false, where.c_str(), samples[i], "a finite float32 value");
  }
  const auto cells = std::make_shared<CellGrid<4>>(height - 1, width - 1);
  for (int row = -1; row < height; ++row) {
    for (int column = -1; column < width; ++column) {
      const double corner = at(row, column), right = at(row, column + 1), up = at(row + 1, column);
      float* cell = cells->at(row, column);
      cell[0] = static_cast<float>(corner);
      cell[1] = static_cast<float>(right - corner);
      cell[2] = static_cast<float>(up - corner);
      cell[3] = static_cast<float>((at(row + 1, column + 1) - up) - (right - corner));
    }
  }
  view_ = cells->view({height - 1, width - 1, geometry.resolution, 0, 0});
  cells_ = cells;
  place(0, 0);
}

void Field::place(double x, double y) {
  const double c = std::cos(geometry_.origin.yaw) / geometry_.resolution,
               s = std::sin(geometry_.origin.yaw) / geometry_.resolution;
  const double dx = x - geometry_.origin.x, dy = y - geometry_.origin.y;
  column_ = {c, s, c * dx + s * dy + 0.5};
  row_ = {-s, c, -s * dx + c * dy + 0.5};
}

Field Field::relative_to(double x, double y) const {
  detail::require(std::isfinite(x) && std::isfinite(y), "field.relative_to", std::isfinite(x) ? y : x,
                  "finite");
  Field field = *this;
  field.place(x, y);
  return field;
}

void Field::evaluate(const float* x, const float* y, std::size_t count, float* value, float* dx,
                     float* dy) const {
  simd::dispatch<EvaluateField>(*this, x, y, count, value, dx, dy);
}

Field signed_distance(const OccupancyGrid& grid, const SignedDistanceOptions& options) {
  check_grid(grid);
  OccupancyGrid seen = options.outside_is_obstacle ? with_border(grid) : grid;
  for (Occupancy& cell : seen.cells) {
    if (cell != Occupancy::unknown) continue;
    cell = options.unknown_is_obstacle ? Occupancy::occupied : Occupancy::free;
  }
  const DistanceField to_obstacles = distance_transform(seen, false);
  OccupancyGrid inverse = seen;
  for (Occupancy& cell : inverse.cells)
    cell = cell == Occupancy::occupied ? Occupancy::free : Occupancy::occupied;
  const DistanceField to_free = distance_transform(inverse, false);
  const double half = 0.5 * seen.resolution, diagonal = seen.resolution * std::hypot(seen.width, seen.height);
  std::vector<double> samples(seen.cells.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i] = seen.cells[i] == Occupancy::occupied ? -std::min(to_free.distance[i] - half, diagonal)
                                                      : std::min(to_obstacles.distance[i] - half, diagonal);
  }
  return Field({seen.width, seen.height, seen.resolution, seen.origin}, samples);
}

}  // namespace slalom::maps
