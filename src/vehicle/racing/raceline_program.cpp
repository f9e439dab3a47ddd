#include "vehicle/racing/raceline_program.hpp"

#include <Eigen/Eigenvalues>

#include "slalom/core/derivatives/dual_math.hpp"

namespace slalom::vehicle::detail {
namespace {

using slalom::detail::plain;
using std::log;
using std::sqrt;

constexpr int variables = 6;  // variables of a segment: four offsets, two speeds
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A number with its first and second derivatives.
using Number = Dual<Dual<double, variables>, variables>;

Number variable(double value, int index) {
  Number made(value);
  made.value.derivative[index] = 1;
  made.derivative[index] = 1;
  return made;
}

/// The second derivatives without their negative eigenvalues.
Eigen::Matrix<double, variables, variables> positive_part(const Number& f) {
  Eigen::Matrix<double, variables, variables> second;
  for (int a = 0; a < variables; ++a)
    for (int b = 0; b < variables; ++b) second(a, b) = f.derivative[a].derivative[b];
  const Eigen::SelfAdjointEigenSolver<decltype(second)> parts(second);
  return parts.eigenvectors() * parts.eigenvalues().cwiseMax(0).asDiagonal() *
         parts.eigenvectors().transpose();
}

template <class T>
struct Vector {
  T x, y;
};

template <class T>
Vector<T> between(const Vector<T>& from, const Vector<T>& to) {
  return {to.x - from.x, to.y - from.y};
}

template <class T>
T squared(const Vector<T>& v) {
  return v.x * v.x + v.y * v.y;
}

/// The curvature of the circle through three points.
template <class T>
T curvature_of(const Vector<T>& a, const Vector<T>& b, const Vector<T>& c) {
  const Vector<T> ab = between(a, b), bc = between(b, c);
  const T cross = ab.x * bc.y - ab.y * bc.x;
  return 2.0 * cross / sqrt(squared(ab) * squared(bc) * squared(between(a, c)));
}

/// Sums barriers. A broken constraint makes the sum infinite and stays so.
template <class T>
struct Barrier {
  T sum{0.0};
  bool broken = false;

  /// `room` > 0 is the constraint.
  void add(const T& room) {
    if (plain(room) > 0)
      sum = sum - log(room);
    else
      broken = true;
  }
};

}  // namespace

template <class T>
T RacelineProgram::segment(int i, const T (&offset)[4], const T (&square)[2], double weight) const {
  int nodes[4];
  segment_points(i, nodes);
  Vector<T> p[4];
  for (int k = 0; k < 4; ++k) {
    const maps::Point &c = corridor_.centre_line[nodes[k]], &e = corridor_.normal[nodes[k]];
    p[k] = {c.x + e.x * offset[k], c.y + e.y * offset[k]};
  }
  const maps::Point &from = corridor_.centre_line[nodes[1]], &to = corridor_.centre_line[nodes[2]];
  const Vector<T> step = between(p[1], p[2]);
  Barrier<T> barrier;
  // A line that turns back on itself is not a raceline.
  if (!(plain(step.x) * (to.x - from.x) + plain(step.y) * (to.y - from.y) > 0)) return T(infinity);
  if (!(plain(square[0]) > 0 && plain(square[1]) > 0)) return T(infinity);

  const T way = sqrt(squared(step));
  const T speed[2] = {sqrt(square[0]), sqrt(square[1])};  // shares of the top speed
  const T time = (2 / car_.limits.top_speed) * way / (speed[0] + speed[1]);
  const T along = (0.5 * top_square_) * (square[1] - square[0]) / way;
  const bool forwards = plain(along) > 0;
  const bool bends[2] = {closed_ || i > 0, closed_ || i + 2 < count_};
  T curvature[2] = {T(0.0), T(0.0)};
  for (int k = 0; k < 2; ++k) {
    if (bends[k]) curvature[k] = curvature_of(p[k], p[k + 1], p[k + 2]);
    const T across = top_square_ * square[k] * curvature[k] / T(car_.limits.lateral_acceleration);
    const T used = along / T(forwards ? car_.limits.acceleration : car_.limits.braking);
    barrier.add(1.0 - (across * across + used * used));
  }
  if (std::isfinite(car_.power)) barrier.add(1.0 - (car_.limits.top_speed / car_.power) * (along * speed[0]));
  if (bends[0]) {
    const T share = (1 / curvature_limit_) * curvature[0];
    barrier.add(1.0 - share * share);
  }
  if (bends[0] && bends[1]) {
    const T rate = (car_.limits.top_speed * car_.wheelbase / car_.max_steering_rate) *
                   ((curvature[1] - curvature[0]) * speed[0] / way);
    barrier.add(1.0 - rate * rate);
  }
  if (barrier.broken) return T(infinity);
  return time + weight * barrier.sum;
}

RacelineProgram::RacelineProgram(const Corridor& corridor, const RacingCar& car)
    : corridor_(corridor),
      car_(car),
      count_(static_cast<int>(corridor.centre_line.size())),
      closed_(corridor.closed),
      curvature_limit_(max_curvature(car)),
      top_square_(car.limits.top_speed * car.limits.top_speed) {
  for (std::size_t i = 0; i < corridor.left.size(); ++i) {
    const double keep = wall_distance(car, corridor.left[i] + corridor.right[i]);
    lower_.push_back(keep - corridor.right[i]);
    upper_.push_back(corridor.left[i] - keep);
  }
}

std::vector<maps::Point> RacelineProgram::line(const RacelineState& state) const {
  std::vector<maps::Point> points;
  for (int i = 0; i < count_; ++i) {
    const maps::Point &c = corridor_.centre_line[i], &e = corridor_.normal[i];
    points.push_back({c.x + state.offset[i] * e.x, c.y + state.offset[i] * e.y});
  }
  return points;
}

double RacelineProgram::time(const RacelineState& state) const {
  const auto points = line(state);
  double sum = 0;
  for (int i = 0; i < segments(); ++i) {
    const int next = (i + 1) % count_;
    sum += 2 * std::hypot(points[next].x - points[i].x, points[next].y - points[i].y) /
           (car_.limits.top_speed * (std::sqrt(state.square[i]) + std::sqrt(state.square[next])));
  }
  return sum;
}

double RacelineProgram::value(const RacelineState& state, double weight) const {
  double sum = 0;
  int nodes[4];
  for (int i = 0; i < count_; ++i) {
    const double below = state.offset[i] - lower_[i], above = upper_[i] - state.offset[i],
                 slower = 1 - state.square[i];
    if (!(below > 0 && above > 0 && slower > 0)) return infinity;
    sum -= weight * std::log(below * above * slower);
  }
  for (int i = 0; i < segments(); ++i) {
    segment_points(i, nodes);
    const double offset[4] = {state.offset[nodes[0]], state.offset[nodes[1]], state.offset[nodes[2]],
                              state.offset[nodes[3]]};
    const double square[2] = {state.square[nodes[1]], state.square[nodes[2]]};
    sum += segment<double>(i, offset, square, weight);
    if (!std::isfinite(sum)) return infinity;
  }
  return sum;
}

void RacelineProgram::derivatives(const RacelineState& state, double weight, Eigen::VectorXd& gradient,
                                  Eigen::SparseMatrix<double>& hessian) const {
  gradient.setZero(2 * count_);
  std::vector<Eigen::Triplet<double>> second;
  for (int i = 0; i < count_; ++i) {
    const double below = 1 / (state.offset[i] - lower_[i]), above = 1 / (upper_[i] - state.offset[i]),
                 slower = 1 / (1 - state.square[i]);
    gradient[2 * i] += weight * (above - below);
    second.emplace_back(2 * i, 2 * i, weight * (above * above + below * below));
    gradient[2 * i + 1] += weight * slower;
    second.emplace_back(2 * i + 1, 2 * i + 1, weight * slower * slower);
  }
  int nodes[4], rows[variables];
  for (int i = 0; i < segments(); ++i) {
    segment_points(i, nodes);
    Number offset[4], square[2];
    for (int k = 0; k < 4; ++k) {
      offset[k] = variable(state.offset[nodes[k]], k);
      rows[k] = 2 * nodes[k];
    }
    for (int k = 0; k < 2; ++k) {
      square[k] = variable(state.square[nodes[k + 1]], 4 + k);
      rows[4 + k] = 2 * nodes[k + 1] + 1;
    }
    const Number part = segment<Number>(i, offset, square, weight);
    const auto positive = positive_part(part);
    for (int a = 0; a < variables; ++a) {
      gradient[rows[a]] += part.value.derivative[a];
      for (int b = 0; b < variables; ++b) second.emplace_back(rows[a], rows[b], positive(a, b));
    }
  }
  hessian.resize(2 * count_, 2 * count_);
  hessian.setFromTriplets(second.begin(), second.end());
}

void RacelineProgram::segment_points(int i, int (&nodes)[4]) const {
  for (int k = 0; k < 4; ++k) {
    const int node = i - 1 + k;
    nodes[k] = closed_ ? (node + count_) % count_ : std::clamp(node, 0, count_ - 1);
  }
}

}  // namespace slalom::vehicle::detail
