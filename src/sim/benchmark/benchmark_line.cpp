#include <algorithm>

#include "slalom/sim/racing_benchmark.hpp"

namespace slalom::sim {
namespace {

constexpr double table_rate = 100;  // rows per m of the program's table of points

/// Solves the cyclic tridiagonal system  below_i x_{i-1} + middle_i x_i + above_i x_{i+1} = right_i  by the
/// formula of Sherman and Morrison (Press et al., "Numerical Recipes", 2007, Sec. 2.7).
std::vector<double> solve_cyclic(const std::vector<double>& below, std::vector<double> middle,
                                 const std::vector<double>& above, std::vector<double> right) {
  const std::size_t n = middle.size();
  const double corner = below[0], other = above[n - 1], gamma = -middle[0];
  middle[0] -= gamma;
  middle[n - 1] -= corner * other / gamma;
  std::vector<double> column(n, 0.0);
  column[0] = gamma;
  column[n - 1] = other;
  for (std::size_t i = 1; i < n; ++i) {
    const double share = below[i] / middle[i - 1];
    middle[i] -= share * above[i - 1];
    right[i] -= share * right[i - 1];
    column[i] -= share * column[i - 1];
  }
  for (std::size_t i = n; i-- > 0;) {
    const bool last = i + 1 == n;
    right[i] = (right[i] - (last ? 0 : above[i] * right[i + 1])) / middle[i];
    column[i] = (column[i] - (last ? 0 : above[i] * column[i + 1])) / middle[i];
  }
  const double factor =
      (right[0] + corner * right[n - 1] / gamma) / (1 + column[0] + corner * column[n - 1] / gamma);
  for (std::size_t i = 0; i < n; ++i) right[i] -= factor * column[i];
  return right;
}

}  // namespace

BenchmarkLine::BenchmarkLine(std::vector<maps::Point> rows) : rows_(std::move(rows)), arc_{0}, parameter_{0} {
  if (rows_.size() < 4)
    throw std::invalid_argument("centre line: " + std::to_string(rows_.size()) +
                                " rows; at least 4 are needed");
  const std::size_t n = rows_.size() - 1;  // points of the spline: the last row repeats the first
  const auto knot = [&](std::size_t i) { return rows_[i % n]; };
  for (std::size_t i = 0; i < n; ++i) {
    arc_.push_back(arc_[i] + distance(rows_[i], rows_[i + 1]));
    parameter_.push_back(parameter_[i] + distance(knot(i), knot(i + 1)));
    if (!(arc_[i + 1] > arc_[i]) || !(parameter_[i + 1] > parameter_[i]) || !std::isfinite(arc_[i + 1]))
      throw std::invalid_argument("centre line: row " + std::to_string(i + 2) +
                                  " must be finite and differ from the one before");
  }
  for (double& parameter : parameter_) parameter /= parameter_.back();
  // Second derivatives such that the first ones are continuous.
  std::vector<double> below(n), middle(n), above(n), x(n), y(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = i == 0 ? n - 1 : i - 1;
    below[i] = parameter_[before + 1] - parameter_[before];
    above[i] = parameter_[i + 1] - parameter_[i];
    middle[i] = 2 * (below[i] + above[i]);
    const maps::Point a = knot(before), b = knot(i), c = knot(i + 1);
    x[i] = 6 * ((c.x - b.x) / above[i] - (b.x - a.x) / below[i]);
    y[i] = 6 * ((c.y - b.y) / above[i] - (b.y - a.y) / below[i]);
  }
  x = solve_cyclic(below, middle, above, std::move(x));
  y = solve_cyclic(below, middle, above, std::move(y));
  for (std::size_t i = 0; i < n; ++i) curvature_.push_back({x[i], y[i]});
  curvature_.push_back(curvature_.front());
}

maps::Point BenchmarkLine::at(double parameter, maps::Point* slope) const noexcept {
  const std::size_t n = rows_.size() - 1;
  const double u = std::clamp(parameter, 0.0, 1.0);
  const auto after = std::upper_bound(parameter_.begin() + 1, parameter_.end() - 1, u);
  const auto i = static_cast<std::size_t>(after - parameter_.begin()) - 1;
  const double h = parameter_[i + 1] - parameter_[i], b = (u - parameter_[i]) / h, a = 1 - b;
  const maps::Point &from = rows_[i], &to = rows_[(i + 1) % n], &bend = curvature_[i],
                    &next = curvature_[i + 1];
  if (slope)
    *slope = {(to.x - from.x) / h + h / 6 * ((3 * b * b - 1) * next.x - (3 * a * a - 1) * bend.x),
              (to.y - from.y) / h + h / 6 * ((3 * b * b - 1) * next.y - (3 * a * a - 1) * bend.y)};
  const double p = (a * a * a - a) * h * h / 6, q = (b * b * b - b) * h * h / 6;
  return {a * from.x + b * to.x + p * bend.x + q * next.x, a * from.y + b * to.y + p * bend.y + q * next.y};
}

maps::Pose BenchmarkLine::pose(double parameter) const noexcept {
  maps::Point slope;
  const maps::Point point = at(parameter, &slope);
  return {point.x, point.y, std::atan2(slope.y, slope.x)};
}

/// The program looks for the nearest point of a table that was meant to have one every centimetre. Its
/// parameters are metres instead of shares, so beyond the first metre all its points are the spline's end.
double BenchmarkLine::nearest_arc(const maps::Point& point, std::size_t row) const noexcept {
  const double count = std::floor(length() * table_rate), spacing = length() / (count - 1);
  const double first = std::floor(arc_[row] * table_rate), end = std::floor(arc_[row + 1] * table_rate);
  double best = first, least = distance(point, at(first * spacing, nullptr));
  for (double k = first + 1; k < end && (k - 1) * spacing < 1; ++k) {
    const double apart = distance(point, at(k * spacing, nullptr));
    if (apart >= least) continue;
    least = apart;
    best = k;
  }
  return best * spacing;
}

double BenchmarkLine::progress(const maps::Point& point) const noexcept {
  const std::size_t last = rows_.size() - 1;
  std::size_t nearest = 0;
  for (std::size_t i = 1; i <= last; ++i)
    if (distance(point, rows_[i]) < distance(point, rows_[nearest])) nearest = i;
  const auto apart = [&](std::size_t i) { return distance(point, rows_[i]); };
  if (nearest == 0) return apart(last) < apart(1) ? 1 : nearest_arc(point, 0) / length();
  if (nearest == last) return apart(last - 1) < apart(0) ? nearest_arc(point, last - 1) / length() : 1;
  if (apart(nearest + 1) > apart(nearest - 1)) --nearest;
  return nearest_arc(point, nearest) / length();
}

}  // namespace slalom::sim
