#include "tracking/tracked.hpp"

#include "slalom/core/math.hpp"

namespace slalom::tracking {
namespace {

constexpr double new_position_deviation = 0.08;  // m, of a box whose yaw is not known
constexpr double yaw_floor = 0.04;               // rad, of measured yaws
constexpr double slip = 0.05;                    // rad, from the yaw to the direction of travel
constexpr double min_travel = 1.0;               // m/s, from which the velocity gives the yaw
constexpr double known_speed = 4;                // standard deviations of a speed that gives the yaw
constexpr double known_rest = 0.6;  // m/s, deviation of the speed of an object that stands or crawls
constexpr double unknown_yaw_deviation = 0.4;  // rad
constexpr double unknown_turn_deviation = 2;   // rad/s
constexpr double round_deviation = 0.03;       // m, of the middle of a round object, for its limbs
constexpr double min_walk = 0.1;               // m/s, from which the velocity of a round object gives its yaw

/// The yaw of a new box: the longer side of the fit, or the line of sight if that side is no longer than an
/// object is wide.
double yaw_of(const BoxFit& fit, const TrackerOptions& options, double bearing) noexcept {
  const int longer = fit.extent[1] > fit.extent[0] ? 1 : 0;
  const double along = fit.angle + longer * right_angle;
  if (fit.extent[longer] > 0.5 * (options.width + options.length)) return along;
  // The visible end is the front or the rear: the axis of the fit that points away from the sensor.
  const double away = maps::wrap_angle(bearing - fit.angle);
  return fit.angle + right_angle * std::round(away / right_angle);
}

/// Corrects x and y with the middle of a box of this yaw (rad), whose variances are larger by `floor` (m^2).
template <int Size>
void correct_middle(Gaussian<Size>& state, const AxisMeasurement (&axes)[2], double yaw, double floor) {
  const double c = std::cos(yaw), s = std::sin(yaw);
  // Both are measured from the same prediction.
  const double before[2] = {state.mean[0], state.mean[1]};
  state.correct({c, s}, axes[0].offset, axes[0].variance + floor);
  const double moved = -s * (state.mean[0] - before[0]) + c * (state.mean[1] - before[1]);
  state.correct({-s, c}, axes[1].offset - moved, axes[1].variance + floor);
}

}  // namespace

Tracked::Tracked(int id, const TrackerOptions& options, const Readings& scan,
                 std::span<const Reading> readings) noexcept
    : id_(id),
      round_(options.length == options.width),
      size_{options.length, options.width},
      size_variance_{square(options.size_deviation), square(options.size_deviation)} {
  const maps::Point& middle = readings[readings.size() / 2].point;
  point_.mean[0] = middle.x;
  point_.mean[1] = middle.y;
  point_.covariance[0][0] = point_.covariance[1][1] = square(options.length);
  point_.covariance[2][2] = point_.covariance[3][3] = square(options.max_speed / 3);
  correct_new(options, scan, readings);
  scans_ = 1;
}

void Tracked::predict(double elapsed, const TrackerOptions& options) noexcept {
  unseen_ += elapsed;
  const double half = 0.5 * elapsed * elapsed;
  if (!turns_) {
    const double transition[4][4] = {{1, 0, elapsed, 0}, {0, 1, 0, elapsed}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    point_.mean[0] += elapsed * point_.mean[2];
    point_.mean[1] += elapsed * point_.mean[3];
    point_.propagate(transition);
    point_.add_noise({half, 0, elapsed, 0}, square(options.acceleration_deviation));
    point_.add_noise({0, half, 0, elapsed}, square(options.acceleration_deviation));
    return;
  }
  double(&x)[5] = state_.mean;
  // Along the chord of the arc, whose direction is the yaw at half of the time.
  const double turn = 0.5 * x[4] * elapsed;
  const double chord = elapsed * (std::abs(turn) > 1e-6 ? std::sin(turn) / turn : 1);
  const double c = std::cos(x[2] + turn), s = std::sin(x[2] + turn);
  const double way = chord * x[3];
  const double transition[5][5] = {{1, 0, -way * s, chord * c, -0.5 * elapsed * way * s},
                                   {0, 1, way * c, chord * s, 0.5 * elapsed * way * c},
                                   {0, 0, 1, 0, elapsed},
                                   {0, 0, 0, 1, 0},
                                   {0, 0, 0, 0, 1}};
  x[0] += way * c;
  x[1] += way * s;
  x[2] = maps::wrap_angle(x[2] + x[4] * elapsed);
  state_.propagate(transition);
  state_.add_noise({half * c, half * s, 0, elapsed, 0}, square(options.acceleration_deviation));
  state_.add_noise({0, 0, half, 0, elapsed}, square(options.yaw_acceleration_deviation));
  state_.add_noise({-s, c, 0, 0, 0}, square(slip * way));
}

/// A box whose yaw is not known: the fit gives it, and the position counts less. A round object looks the
/// same from all sides, so that its box may lie along the line of sight.
void Tracked::correct_new(const TrackerOptions& options, const Readings& scan,
                          std::span<const Reading> readings) noexcept {
  const double bearing = std::atan2(point_.mean[1] - scan.sensor().y, point_.mean[0] - scan.sensor().x);
  yaw_ = round_ ? bearing : yaw_of(fit_box(readings, options.range_deviation), options, bearing);
  const double speed = std::hypot(point_.mean[2], point_.mean[3]);
  if (!round_ && scans_ > 1 && speed > min_travel) {
    const double travel = std::atan2(point_.mean[3], point_.mean[2]);
    yaw_ += right_angle * std::round(maps::wrap_angle(travel - yaw_) / right_angle);
  }
  AxisMeasurement axes[2];
  measure_box({{point_.mean[0], point_.mean[1], yaw_}, {size_[0], size_[1]}, options.size_deviation}, scan,
              readings, options.min_incidence, options.range_deviation, axes);
  correct_middle(point_, axes, yaw_, square(round_ ? round_deviation : new_position_deviation));
}

void Tracked::correct_size(const AxisMeasurement (&axes)[2], double deviation) noexcept {
  for (int i = 0; i < 2; ++i) {
    if (axes[i].size <= 0) continue;
    // Ends are biased the same way in many scans, so a measurement counts little, and the variance stays.
    const double variance = 4 * axes[i].variance + square(2 * deviation);
    const double gain = size_variance_[i] / (size_variance_[i] + variance);
    size_[i] = std::max(deviation, size_[i] + gain * (axes[i].size - size_[i]));
    size_variance_[i] = std::max(size_variance_[i] * (1 - gain), square(0.5 * deviation));
  }
}

void Tracked::correct(const TrackerOptions& options, const Readings& scan, std::span<const Reading> readings,
                      bool moves) noexcept {
  unseen_ = 0;
  misses_ = 0;
  scans_ += moves;
  at_rest_ = moves ? 0 : at_rest_ + 1;
  if (!turns_) {
    correct_new(options, scan, readings);
    take_over();
    return;
  }
  double(&x)[5] = state_.mean;
  const BoxFit fit = fit_box(readings, options.range_deviation);
  if (readings.size() >= 5 && std::max(fit.extent[0], fit.extent[1]) > 0.5 * size_[1]) {
    // A rectangle looks the same after a quarter of a turn.
    const double apart = maps::wrap_angle(fit.angle - x[2]);
    const double innovation = apart - right_angle * std::round(apart / right_angle);
    const double variance = 2 * square(fit.angle_deviation) + square(yaw_floor);
    if (square(innovation) < square(options.gate) * (state_.covariance[2][2] + variance))
      state_.correct({0, 0, 1, 0, 0}, innovation, variance);
  }
  AxisMeasurement axes[2];
  measure_box({{x[0], x[1], x[2]}, {size_[0], size_[1]}, std::sqrt(size_variance_[0])}, scan, readings,
              options.min_incidence, options.range_deviation, axes);
  correct_middle(state_, axes, x[2], 0);
  correct_size(axes, options.range_deviation);
  x[3] = std::clamp(x[3], -options.max_speed, options.max_speed);
  if (x[3] < -0.5 * min_travel) {
    x[2] += std::numbers::pi;
    x[3] = -x[3];
    for (int i = 0; i < 5; ++i) {
      state_.covariance[3][i] = -state_.covariance[3][i];
      state_.covariance[i][3] = -state_.covariance[i][3];
    }
  }
  x[2] = maps::wrap_angle(x[2]);
}

void Tracked::miss(bool seen_through) noexcept {
  if (seen_through) ++misses_;
}

void Tracked::confirm(const TrackerOptions& options, double min_speed) noexcept {
  // Without a map a scan says less.
  if (confirmed_ || unseen_ > 0 || scans_ < (min_speed > 0 ? 2 : 1) * options.confirming_scans) return;
  if (min_speed > 0) {
    const Gaussian<5> motion = turning();
    if (motion.mean[3] < min_speed || square(motion.mean[3]) < 4 * motion.covariance[3][3]) return;
  }
  confirmed_ = true;
}

/// The motion as a state of constant turn rate and speed, as far as it is known.
Gaussian<5> Tracked::turning() const noexcept {
  if (turns_) return state_;
  const double vx = point_.mean[2], vy = point_.mean[3], speed = std::hypot(vx, vy);
  const double c = speed > 0 ? vx / speed : 1, s = speed > 0 ? vy / speed : 0;
  const bool travels = round_ ? speed > min_walk
                              : speed > min_travel && square(speed) > 4 * point_.variance_along({0, 0, c, s});
  const double yaw = travels ? std::atan2(vy, vx) : yaw_;
  const double cosine = std::cos(yaw), sine = std::sin(yaw);
  Gaussian<5> state{{point_.mean[0], point_.mean[1], yaw, cosine * vx + sine * vy, 0}, {}};
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) state.covariance[i][j] = point_.covariance[i][j];
  state.covariance[2][2] = travels ? std::min(1.0, point_.variance_along({0, 0, -s, c}) / square(speed))
                                   : square(unknown_yaw_deviation);
  state.covariance[3][3] = point_.variance_along({0, 0, cosine, sine});
  state.covariance[4][4] = square(unknown_turn_deviation);
  return state;
}

/// Continues with constant turn rate and speed once the velocity is known, so that the yaw is. A round object
/// keeps its velocity: nothing shows where it is heading.
void Tracked::take_over() noexcept {
  if (round_) return;
  const double speed_variance = 0.5 * (point_.covariance[2][2] + point_.covariance[3][3]);
  const bool travels = square(point_.mean[2]) + square(point_.mean[3]) >
                       std::max(square(min_travel), square(known_speed) * speed_variance);
  if (!travels && speed_variance > square(known_rest)) return;
  state_ = turning();
  turns_ = true;
}

bool Tracked::finite() const noexcept {
  const Gaussian<5> state = turning();
  bool finite = std::isfinite(position_variance());
  for (const double value : state.mean) finite = finite && std::isfinite(value);
  return finite;
}

maps::Pose Tracked::pose() const noexcept {
  if (turns_) return {state_.mean[0], state_.mean[1], state_.mean[2]};
  return {point_.mean[0], point_.mean[1], yaw_};
}

double Tracked::position_variance() const noexcept {
  if (turns_) return 0.5 * (state_.covariance[0][0] + state_.covariance[1][1]);
  return 0.5 * (point_.covariance[0][0] + point_.covariance[1][1]);
}

TrackedObject Tracked::object() const noexcept {
  const Gaussian<5> state = turning();
  TrackedObject object{.id = id_,
                       .pose = {state.mean[0], state.mean[1], maps::wrap_angle(state.mean[2])},
                       .speed = state.mean[3],
                       .yaw_rate = state.mean[4],
                       .length = size_[0],
                       .width = size_[1],
                       .unseen = unseen_};
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) object.covariance[i][j] = state.covariance[i][j];
  return object;
}

}  // namespace slalom::tracking
