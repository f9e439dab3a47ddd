#include "slalom/vehicle/racing/minimum_time.hpp"

#include <Eigen/SparseCholesky>
#include <cstdio>

#include "vehicle/racing/raceline_program.hpp"

namespace slalom::vehicle {
namespace {

using detail::RacelineProgram;
using detail::RacelineState;

constexpr double weight_factor = 0.3;    // factor of the barrier from one stage to the next
constexpr double last_gap = 1e-4;        // share of the time: constraints times weight in the last stage
constexpr double stage_accuracy = 5e-6;  // share of the value that a step of the last stages must promise
constexpr double centring = 0.01;     // the same in the first stages, as a share of constraints times weight
constexpr int max_newton_steps = 60;  // steps of Newton's method in a stage
constexpr double curvature_room = 1.05;  // factor for a line that is tighter than the car turns
constexpr double start_share = 0.4;      // share of the fastest squared speeds along the first line
constexpr double start_room = 0.1;       // share of the width, from the bounds of the first line

/// The curvature at a point is that of the circle through it and its neighbours.
PathGeometry geometry_of(const std::vector<maps::Point>& p, bool closed) {
  const std::size_t n = p.size();
  PathGeometry g{closed, std::vector<double>(n), std::vector<double>(n)};
  for (std::size_t i = 0; i < n; ++i) {
    const maps::Point &a = p[(i + n - 1) % n], &b = p[i], &c = p[(i + 1) % n];
    g.step[i] = std::hypot(c.x - b.x, c.y - b.y);
    if (!closed && (i == 0 || i + 1 == n)) continue;
    g.curvature[i] = 2 * ((b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x)) /
                     (std::hypot(b.x - a.x, b.y - a.y) * g.step[i] * std::hypot(c.x - a.x, c.y - a.y));
  }
  return g;
}

double tightest(const PathGeometry& geometry) {
  double most = 0;
  for (const double k : geometry.curvature) most = std::max(most, std::abs(k));
  return most;
}

void check(const Corridor& corridor, const RacingCar& car) {
  const std::size_t n = corridor.centre_line.size();
  if (n < 8) throw std::invalid_argument("corridor: " + std::to_string(n) + " points; at least 8 are needed");
  if (corridor.normal.size() != n || corridor.left.size() != n || corridor.right.size() != n)
    throw std::invalid_argument("corridor: points, normals and widths must have the same number");
  const auto width = [&](std::size_t i) { return corridor.left[i] + corridor.right[i]; };
  std::size_t narrowest = 0;
  for (std::size_t i = 1; i < n; ++i)
    if (width(i) < width(narrowest)) narrowest = i;
  if (width(narrowest) > 2 * least_wall_distance(car)) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "corridor: %.3f m wide at (%.2f, %.2f); must be wider than %.3f m, the car with %.1f of its "
                "margin on both sides",
                width(narrowest), corridor.centre_line[narrowest].x, corridor.centre_line[narrowest].y,
                2 * least_wall_distance(car), least_margin_share);
  throw std::invalid_argument(text);
}

/// Improves lines of a program.
class BarrierMethod {
 public:
  BarrierMethod(const Corridor& corridor, const RacingCar& car)
      : corridor_(corridor), car_(car), program_(corridor, car) {}

  RacelineState solve() {
    RacelineState state = first_line();
    if (!std::isfinite(program_.value(state, 1)))
      throw std::invalid_argument(
          "corridor: its normals cross between the walls; the centre line must be smoother or nearer to the "
          "middle");
    double weight = program_.time(state) / program_.constraints();
    for (;;) {
      minimise(state, weight);
      if (weight * program_.constraints() < last_gap * program_.time(state)) return state;
      weight *= weight_factor;
    }
  }

  const RacelineProgram& program() const { return program_; }

 private:
  /// Along the centre line, slowly enough.
  RacelineState first_line() {
    RacelineState state;
    for (int i = 0; i < program_.points(); ++i) {
      const double low = program_.lower(i), high = program_.upper(i), room = start_room * (high - low);
      state.offset.push_back(std::clamp(0.0, low + room, high - room));
    }
    const PathGeometry geometry = geometry_of(program_.line(state), corridor_.closed);
    program_.set_curvature_limit(std::max(max_curvature(car_), curvature_room * tightest(geometry)));
    const double top = car_.limits.top_speed;
    for (const double speed : racing_speeds(geometry.curvature, geometry.step, corridor_.closed, car_))
      state.square.push_back(start_share * speed * speed / (top * top));
    // Limits that depend on the speed may be tighter at lower speeds.
    for (int k = 0; k < 60 && !std::isfinite(program_.value(state, 1)); ++k)
      for (double& square : state.square) square *= 0.5;
    return state;
  }

  /// Newton's method with a line search.
  void minimise(RacelineState& state, double weight) {
    double value = program_.value(state, weight);
    for (int step = 0; step < max_newton_steps; ++step) {
      tighten(state, weight, value);
      const double decrease = direction(state, weight);
      if (decrease < std::max(stage_accuracy * value, centring * weight * program_.constraints())) return;
      double length = 1;
      for (;; length *= 0.5) {
        const RacelineState tried = moved(state, length);
        const double there = program_.value(tried, weight);
        if (there <= value - 0.1 * length * decrease) {
          state = tried;
          value = there;
          break;
        }
        if (length < 1e-10) return;
      }
    }
  }

  /// Brings the limit of the curvature nearer to the car's, as far as the line allows.
  void tighten(const RacelineState& state, double weight, double& value) {
    const double wanted = max_curvature(car_);
    if (program_.curvature_limit() <= wanted) return;
    const double now = tightest(geometry_of(program_.line(state), corridor_.closed));
    program_.set_curvature_limit(std::clamp(curvature_room * now, wanted, program_.curvature_limit()));
    value = program_.value(state, weight);
  }

  /// Computes Newton's step into `step_`; returns the decrease that its slope promises.
  double direction(const RacelineState& state, double weight) {
    program_.derivatives(state, weight, gradient_, hessian_);
    // Only rounding can make the matrix indefinite.
    const double scale = hessian_.diagonal().maxCoeff();
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factors;
    for (double shift = 1e-14 * scale;; shift *= 100) {
      factors.setShift(shift).compute(hessian_);
      if (factors.info() == Eigen::Success) break;
      if (!(shift < scale)) return 0;
    }
    step_ = factors.solve(gradient_);
    return step_.dot(gradient_);
  }

  RacelineState moved(const RacelineState& state, double length) const {
    RacelineState result = state;
    for (int i = 0; i < program_.points(); ++i) {
      result.offset[i] -= length * step_[2 * i];
      result.square[i] -= length * step_[2 * i + 1];
    }
    return result;
  }

  const Corridor& corridor_;
  const RacingCar& car_;
  RacelineProgram program_;
  Eigen::SparseMatrix<double> hessian_;
  Eigen::VectorXd gradient_, step_;
};

Raceline with_speeds(const std::vector<maps::Point>& line, bool closed, const RacingCar& car) {
  const std::size_t n = line.size();
  const PathGeometry geometry = geometry_of(line, closed);
  const auto speed = racing_speeds(geometry.curvature, geometry.step, closed, car);
  Raceline result{.closed = closed};
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = closed || i + 1 < n ? (i + 1) % n : i;
    const std::size_t before = closed || i > 0 ? (i + n - 1) % n : i;
    const double acceleration =
        next == i ? 0 : (speed[next] * speed[next] - speed[i] * speed[i]) / (2 * geometry.step[i]);
    result.points.push_back({result.length, line[i].x, line[i].y,
                             std::atan2(line[next].y - line[before].y, line[next].x - line[before].x),
                             geometry.curvature[i], speed[i], acceleration});
    if (next == i) break;
    result.length += geometry.step[i];
    result.time += 2 * geometry.step[i] / (speed[i] + speed[next]);
  }
  return result;
}

}  // namespace

Raceline minimum_time_raceline(const Corridor& corridor, const RacingCar& car) {
  validate(car);
  check(corridor, car);
  BarrierMethod method(corridor, car);
  const RacelineState state = method.solve();
  Raceline result = with_speeds(method.program().line(state), corridor.closed, car);
  result.curvature_limit = method.program().curvature_limit();
  return result;
}

}  // namespace slalom::vehicle
