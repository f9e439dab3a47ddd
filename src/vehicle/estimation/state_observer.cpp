#include "slalom/vehicle/estimation/state_observer.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "slalom/core/math.hpp"

namespace slalom::vehicle {
namespace {

enum Index { x, y, yaw, speed, yaw_rate, lateral, bias };

constexpr double piece = 0.005;         // s, of a prediction
constexpr double reset_distance = 0.5;  // m or rad; a pose further from the predicted one is a jump
constexpr double slow = 0.5;            // m/s, below it tyres do not slip
constexpr double max_slip = 1.2;        // rad
constexpr double max_variance = 1e6;    // m^2 and rad^2, of a pose
constexpr double bias_spread = 0.02, bias_drift = 1e-4;  // rad/s, at the start and in a period
constexpr double max_bias = 0.5;  // rad/s, largest bias of a working gyro; more comes from a wrong reading

/// The values of an array as a vector of Eigen.
template <std::size_t n>
auto map(std::array<double, n>& values) {
  return Eigen::Map<Eigen::Matrix<double, n, 1>>(values.data());
}
template <std::size_t n>
auto map(const std::array<double, n>& values) {
  return Eigen::Map<const Eigen::Matrix<double, n, 1>>(values.data());
}
/// The values of an array of rows as a matrix of Eigen.
template <std::size_t n>
auto map(std::array<std::array<double, n>, n>& rows) {
  return Eigen::Map<Eigen::Matrix<double, n, n, Eigen::RowMajor>>(rows.front().data());
}

double slip_from(double sideways, double along) noexcept {
  const double safe = std::copysign(std::max(std::abs(along), 0.1), along);
  return std::asin(std::clamp(sideways / safe, -std::sin(max_slip), std::sin(max_slip)));
}

/// Adds the options' variances to the covariance of a pose. An invalid covariance counts as 0: not finite,
/// larger than that of any car, or with correlations above 1.
PoseCovariance with_noise(PoseCovariance pose, const ObserverOptions& options) noexcept {
  double sum = 0;
  for (const auto& row : pose)
    for (const double value : row) sum += std::abs(value);
  bool valid = sum < max_variance;
  for (std::size_t i = 0; i < pose.size(); ++i)
    for (std::size_t j = 0; j < pose.size(); ++j)
      valid = valid && pose[i][i] >= 0 && square(pose[i][j]) <= (1 + 1e-6) * pose[i][i] * pose[j][j];
  if (!valid) pose = {};
  pose[0][0] += square(options.position_noise);
  pose[1][1] += square(options.position_noise);
  pose[2][2] += square(options.heading_noise);
  return pose;
}

}  // namespace

StateObserver::StateObserver(const ObserverOptions& options, double period, double latency, double dead_time)
    : options_(options), period_(period), latency_(latency), delay_(latency + dead_time) {
  reset();
}

void StateObserver::reset() noexcept {
  sent_.fill({0, std::numeric_limits<double>::quiet_NaN()});
  now_ = {};
  known_ = false;
  sent_since_ = 0;
}

void StateObserver::send(const Command& command) noexcept {
  for (std::size_t i = sent_.size() - 1; i > 0; --i) sent_[i] = sent_[i - 1];
  sent_[0] = command;
  ++sent_since_;
}

/// Returns the command that takes effect, after this delay, at a time (s after the last measurements). The
/// newest command was sent one period before these measurements.
const Command& StateObserver::acting(double time, double delay) const noexcept {
  const double periods = std::ceil((delay - time) / period_) - 1;
  return sent_[static_cast<std::size_t>(std::clamp(periods, 0.0, static_cast<double>(sent_.size() - 1)))];
}

/// Moves the car from `begin` to `end`, s after the last measurements.
void StateObserver::move(const DynamicVehicleModel& model, VehicleStart& car, double begin,
                         double end) const noexcept {
  const int pieces = static_cast<int>(std::ceil((end - begin) / piece - 1e-9));
  for (int i = 0; i < pieces; ++i) {
    const double dt = (end - begin) / pieces, middle = begin + (i + 0.5) * dt;
    car = model.advance(car, {acting(middle, delay_).steer, acting(middle, latency_).speed}, dt, friction_);
  }
}

/// Returns the state one period after `from`. `steer` (rad) is the angle of the wheels and moves, too.
StateObserver::Vector StateObserver::moved(const DynamicVehicleModel& model, const Vector& from,
                                           double& steer) const noexcept {
  VehicleStart car{{from[x], from[y], from[yaw]},
                   from[speed],
                   steer,
                   from[yaw_rate],
                   slip_from(from[lateral], from[speed])};
  move(model, car, -period_, 0);
  steer = car.steer;
  return {car.pose.x, car.pose.y, car.pose.yaw, car.speed, car.yaw_rate, car.speed * std::sin(car.slip),
          from[bias]};
}

/// Restarts the filter, with the state of a car whose tyres do not slip.
void StateObserver::begin(const DynamicVehicleModel& model, const ObserverInput& input) noexcept {
  const VehicleTraits traits = model.traits();
  const double slope = std::tan(now_.steer) / traits.wheelbase;
  const double gyro = known_ ? state_[bias] : 0;
  now_ = {input.pose, input.speed, now_.steer, input.speed * slope, std::atan(traits.rear_length * slope)};
  state_ = {now_.pose.x, now_.pose.y,   now_.pose.yaw,
            now_.speed,  now_.yaw_rate, now_.speed * std::sin(now_.slip),
            gyro};
  const double bias_variance = known_ ? covariance_[bias][bias] : square(bias_spread);
  covariance_ = {};
  const PoseCovariance pose = with_noise(input.covariance, options_);
  for (std::size_t i = 0; i < pose.size(); ++i)
    for (std::size_t j = 0; j < pose.size(); ++j) covariance_[i][j] = pose[i][j];
  covariance_[speed][speed] = square(options_.speed_noise);
  covariance_[yaw_rate][yaw_rate] = square(0.3 * std::abs(input.speed) * std::abs(slope) + 0.05);
  covariance_[lateral][lateral] = square(0.05 * std::abs(input.speed) + 0.01);
  covariance_[bias][bias] = bias_variance;
}

/// Predicts state and covariance one period ahead: F P F' + Q. Accelerometers share in the prediction.
void StateObserver::predict(const DynamicVehicleModel& model, const std::optional<ImuReading>& imu) noexcept {
  const Vector before = state_;
  const double steer_before = now_.steer;
  Matrix f{};
  for (std::size_t i = 0; i < size; ++i) f[i][i] = 1;
  state_ = moved(model, before, now_.steer);
  f[x][yaw] = -(state_[y] - before[y]);
  f[y][yaw] = state_[x] - before[x];
  constexpr double difference = 1e-4;
  for (const std::size_t column : {std::size_t{speed}, std::size_t{yaw_rate}, std::size_t{lateral}}) {
    Vector other = before;
    other[column] += difference;
    double steer = steer_before;
    other = moved(model, other, steer);
    for (std::size_t row = 0; row < bias; ++row) f[row][column] = (other[row] - state_[row]) / difference;
  }
  const double dt = period_;
  Vector noise{1e-6,
               1e-6,
               1e-8,
               square(options_.acceleration_noise * dt),
               square(options_.yaw_acceleration_noise * dt),
               square(options_.sideways_noise * dt),
               square(bias_drift)};
  if (imu) {
    const double measured = square(options_.accelerometer_noise * dt);
    const double slip = slip_from(before[lateral], before[speed]), s = std::sin(slip), c = std::cos(slip);
    const auto share_in = [&](std::size_t row, double predicted, const Vector& derivative) {
      const double share = noise[row] / (noise[row] + measured);
      state_[row] += share * (predicted - state_[row]);
      for (std::size_t i = 0; i < size; ++i) f[row][i] += share * (derivative[i] - f[row][i]);
      noise[row] *= 1 - share;
    };
    const double rate = 0.5 * (before[yaw_rate] + state_[yaw_rate]);
    Vector derivative{};
    derivative[lateral] = 1;
    derivative[speed] = -rate * c * dt;
    derivative[yaw_rate] = -before[speed] * c * dt;
    share_in(lateral, before[lateral] + dt * (imu->leftward - before[speed] * c * rate), derivative);
    derivative = {};
    derivative[speed] = 1;
    share_in(speed, before[speed] + dt * (imu->forward * c + imu->leftward * s), derivative);
  }
  Eigen::Matrix<double, size, size> half, made;
  half.setZero();
  made.setZero();
  for (int k = 0; k < size; ++k) half += map(f).col(k) * map(covariance_).row(k);
  for (int k = 0; k < size; ++k) made += half.col(k) * map(f).col(k).transpose();
  map(covariance_) = made;
  map(covariance_).diagonal() += map(noise);
}

/// Takes a measurement of `row` times the state. `difference` is the measured minus the predicted value.
void StateObserver::correct(const Vector& row, double difference, double variance) noexcept {
  Eigen::Matrix<double, size, 1> shared;
  shared.setZero();
  for (int k = 0; k < size; ++k) shared += map(covariance_).col(k) * row[static_cast<std::size_t>(k)];
  const double total = std::inner_product(row.begin(), row.end(), shared.begin(), variance);
  map(state_) += shared * (difference / total);
  map(covariance_) -= shared * shared.transpose() / total;
}

/// Takes the pose as three independent measurements. Its covariance is L D L^T (L has ones on its diagonal),
/// so L^-1 times the pose has the variances D and no correlations.
void StateObserver::correct_pose(const ObserverInput& input) noexcept {
  const PoseCovariance c = with_noise(input.covariance, options_);
  const double yx = c[1][0] / c[0][0], hx = c[2][0] / c[0][0];
  // These bounds hold for every positive semidefinite matrix. They protect against others.
  const double y_variance = std::max(c[1][1] - yx * c[1][0], square(options_.position_noise));
  const double coupling = c[2][1] - hx * c[1][0], hy = coupling / y_variance;
  const double yaw_variance =
      std::max(c[2][2] - hx * c[2][0] - hy * coupling, square(options_.heading_noise));
  const Vector rows[3] = {{1}, {-yx, 1}, {hy * yx - hx, -hy, 1}};
  const double variances[3] = {c[0][0], y_variance, yaw_variance};
  for (std::size_t i = 0; i < 3; ++i) {
    const double differences[3] = {input.pose.x - state_[x], input.pose.y - state_[y],
                                   maps::wrap_angle(input.pose.yaw - state_[yaw])};
    double difference = 0;
    for (std::size_t j = 0; j < 3; ++j) difference += rows[i][j] * differences[j];
    correct(rows[i], difference, variances[i]);
  }
}

void StateObserver::update(const DynamicVehicleModel& model, const ObserverInput& input,
                           double friction) noexcept {
  friction_ = friction;
  const bool missed = sent_since_ > 1;
  sent_since_ = 0;
  if (!known_ || missed || std::abs(input.speed) < slow) {
    if (known_) move(model, now_, -period_, 0);
    begin(model, input);
    known_ = true;
    return;
  }
  predict(model, input.imu);
  const double turned = maps::wrap_angle(input.pose.yaw - state_[yaw]);
  if (!(std::hypot(input.pose.x - state_[x], input.pose.y - state_[y]) < reset_distance &&
        std::abs(turned) < reset_distance))
    return begin(model, input);
  correct_pose(input);
  correct({0, 0, 0, 1}, input.speed - state_[speed], square(options_.speed_noise));
  if (input.imu)
    correct({0, 0, 0, 0, 1, 0, 1}, input.imu->yaw_rate - state_[yaw_rate] - state_[bias],
            square(options_.gyro_noise));
  state_[bias] = std::clamp(state_[bias], -max_bias, max_bias);
  now_ = {{state_[x], state_[y], maps::wrap_angle(state_[yaw])},
          state_[speed],
          now_.steer,
          state_[yaw_rate],
          slip_from(state_[lateral], state_[speed])};
  state_[yaw] = now_.pose.yaw;
}

VehicleStart StateObserver::ahead(const DynamicVehicleModel& model) const noexcept {
  VehicleStart car = now_;
  move(model, car, 0, delay_);
  return car;
}

double StateObserver::speed_ahead(const DynamicVehicleModel& model) const noexcept {
  VehicleStart car = now_;
  move(model, car, 0, latency_);
  return car.speed;
}

}  // namespace slalom::vehicle
