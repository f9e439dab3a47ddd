#include "vehicle/estimation/state_observer.hpp"

#include "slalom/core/math.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::vehicle::detail {
namespace {

enum Index { x, y, yaw, speed, yaw_rate, lateral, bias };

// Standard deviations of measurements: a speed, and the means over a control period of gyro and
// accelerometers (with their bias).
constexpr double speed_noise = 0.1, gyro_noise = 0.01, accelerometer_noise = 0.5;  // m/s, rad/s, m/s^2
// Standard deviations of the model's accelerations: along the car, across it, and of the yaw.
constexpr double acceleration_noise = 5, sideways_noise = 2, yaw_acceleration_noise = 8;  // m/s^2, rad/s^2

constexpr double piece = 0.005;         // s, of a prediction
constexpr double reset_distance = 0.5;  // m or rad; a pose further from the predicted one is a jump
constexpr double slow = 0.5;            // m/s, below it tyres do not slip
constexpr double max_slip = 1.2;        // rad
constexpr double max_variance = 1e6;    // m^2 and rad^2, of a pose
constexpr double bias_spread = 0.02, bias_drift = 1e-4;     // rad/s, at the start and in a period
constexpr double wheel_spread = 0.03, wheel_drift = 0.001;  // shares, at the start and in a stretch
constexpr double stretch = 2;                               // m, over which wheels and poses are compared
constexpr double largest_wheel_error = 0.2;
constexpr double steady = 1;         // m/s^2, up to which the wheels hardly slip
constexpr double wheel_slip = 0.01;  // s^2/m, share by which they slip for each m/s^2
constexpr double max_bias = 0.5;     // rad/s, largest bias of a working gyro; more comes from a wrong reading

/// The product of two matrices. Its sums have a fixed order on every machine.
template <class Matrix>
Matrix product(const Matrix& a, const Matrix& b) {
  Matrix sum = Matrix::Zero();
  for (Eigen::Index k = 0; k < a.cols(); ++k) sum += a.col(k) * b.row(k);
  return sum;
}

double slip_from(double sideways, double along) noexcept {
  const double safe = std::copysign(std::max(std::abs(along), 0.1), along);
  return std::asin(std::clamp(sideways / safe, -std::sin(max_slip), std::sin(max_slip)));
}

/// Adds the variances of noise (m, rad) to the covariance of a pose. An invalid covariance counts as 0: not
/// finite, larger than that of any car, or with correlations above 1.
PoseCovariance with_noise(PoseCovariance pose, double position_noise, double heading_noise) noexcept {
  double sum = 0;
  for (const auto& row : pose)
    for (const double value : row) sum += std::abs(value);
  bool valid = sum < max_variance;
  for (std::size_t i = 0; i < pose.size(); ++i)
    for (std::size_t j = 0; j < pose.size(); ++j)
      valid = valid && pose[i][i] >= 0 && square(pose[i][j]) <= (1 + 1e-6) * pose[i][i] * pose[j][j];
  if (!valid) pose = {};
  pose[0][0] += square(position_noise);
  pose[1][1] += square(position_noise);
  pose[2][2] += square(heading_noise);
  return pose;
}

}  // namespace

StateObserver::StateObserver(const EstimationOptions& options, double period, double latency,
                             double dead_time)
    : position_noise_(options.position_noise),
      heading_noise_(options.heading_noise),
      period_(period),
      latency_(latency),
      delay_(latency + dead_time) {
  reset();
}

void StateObserver::reset() noexcept {
  sent_.fill({0, std::numeric_limits<double>::quiet_NaN()});
  now_ = {};
  known_ = false;
  sent_since_ = 0;
  wheel_error_ = 0;
  wheel_variance_ = square(wheel_spread);
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
  return sent_[saturate_cast<std::size_t>(std::clamp(periods, 0.0, static_cast<double>(sent_.size() - 1)))];
}

/// Moves the car from `begin` to `end`, s after the last measurements.
void StateObserver::move(const DynamicVehicleModel& model, VehicleStart& car, double begin,
                         double end) const noexcept {
  const int pieces = saturate_cast<int>(std::ceil((end - begin) / piece - 1e-9));
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
  return Vector{car.pose.x, car.pose.y, car.pose.yaw, car.speed, car.yaw_rate, car.speed * std::sin(car.slip),
                from[bias]};
}

/// Restarts the filter, with the state of a car whose tyres do not slip.
void StateObserver::begin(const DynamicVehicleModel& model, const ObserverInput& input) noexcept {
  const VehicleTraits traits = model.traits();
  const double slope = std::tan(now_.steer) / traits.wheelbase;
  const double gyro = known_ ? state_[bias] : 0;
  now_ = {input.pose, input.speed, now_.steer, input.speed * slope, std::atan(traits.rear_length * slope)};
  state_ = Vector{now_.pose.x, now_.pose.y,   now_.pose.yaw,
                  now_.speed,  now_.yaw_rate, now_.speed * std::sin(now_.slip),
                  gyro};
  const double bias_variance = known_ ? covariance_(bias, bias) : square(bias_spread);
  covariance_.setZero();
  const PoseCovariance pose = with_noise(input.covariance, position_noise_, heading_noise_);
  for (std::size_t i = 0; i < pose.size(); ++i)
    for (std::size_t j = 0; j < pose.size(); ++j)
      covariance_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = pose[i][j];
  covariance_(speed, speed) = square(speed_noise);
  covariance_(yaw_rate, yaw_rate) = square(0.3 * std::abs(input.speed) * std::abs(slope) + 0.05);
  covariance_(lateral, lateral) = square(0.05 * std::abs(input.speed) + 0.01);
  covariance_(bias, bias) = bias_variance;
}

/// Predicts state and covariance one period ahead: F P F' + Q.
void StateObserver::predict(const DynamicVehicleModel& model, const std::optional<ImuReading>& imu) noexcept {
  const Vector before = state_;
  const double steer_before = now_.steer, dt = period_;
  state_ = moved(model, before, now_.steer);
  Matrix slope = slopes(model, before, steer_before);
  Vector noise{1e-6,
               1e-6,
               1e-8,
               square(acceleration_noise * dt),
               square(yaw_acceleration_noise * dt),
               square(sideways_noise * dt),
               square(bias_drift)};
  if (imu) use_accelerometers(*imu, before, slope, noise);
  covariance_ = product<Matrix>(product<Matrix>(slope, covariance_), slope.transpose());
  covariance_.diagonal() += noise;
}

/// Returns the derivatives of `state_` by the state one period before: for speeds by differences.
StateObserver::Matrix StateObserver::slopes(const DynamicVehicleModel& model, const Vector& before,
                                            double steer) const noexcept {
  constexpr double difference = 1e-4;
  Matrix slope = Matrix::Identity();
  slope(x, yaw) = -(state_[y] - before[y]);
  slope(y, yaw) = state_[x] - before[x];
  for (const Index column : {speed, yaw_rate, lateral}) {
    Vector other = before;
    other[column] += difference;
    double moved_steer = steer;
    other = moved(model, other, moved_steer);
    for (int row = 0; row < bias; ++row) slope(row, column) = (other[row] - state_[row]) / difference;
  }
  return slope;
}

/// Lets the accelerometers share in the prediction of speed and sideways velocity.
void StateObserver::use_accelerometers(const ImuReading& imu, const Vector& before, Matrix& slope,
                                       Vector& noise) noexcept {
  const double dt = period_, rate = 0.5 * (before[yaw_rate] + state_[yaw_rate]);
  const double slip = slip_from(before[lateral], before[speed]), s = std::sin(slip), c = std::cos(slip);
  const auto share_in = [&](Index row, double predicted, const Vector& derivative) {
    const double share = noise[row] / (noise[row] + square(accelerometer_noise * dt));
    state_[row] += share * (predicted - state_[row]);
    for (int i = 0; i < size; ++i) slope(row, i) += share * (derivative[i] - slope(row, i));
    noise[row] *= 1 - share;
  };
  Vector sideways = Vector::Unit(lateral);
  sideways[speed] = -rate * c * dt;
  sideways[yaw_rate] = -before[speed] * c * dt;
  share_in(lateral, before[lateral] + dt * (imu.leftward - before[speed] * c * rate), sideways);
  share_in(speed, before[speed] + dt * (imu.forward * c + imu.leftward * s), Vector::Unit(speed));
}

/// Takes a measurement of `row` times the state. `difference` is the measured minus the predicted value.
void StateObserver::correct(const Vector& row, double difference, double variance) noexcept {
  Vector shared = Vector::Zero();
  for (int k = 0; k < size; ++k) shared += covariance_.col(k) * row[k];
  double total = variance;
  for (int k = 0; k < size; ++k) total += row[k] * shared[k];
  state_ += shared * (difference / total);
  covariance_ -= shared * shared.transpose() / total;
}

/// Takes the pose as three independent measurements. Its covariance is L D L^T (L has ones on its diagonal),
/// so L^-1 times the pose has the variances D and no correlations.
void StateObserver::correct_pose(const ObserverInput& input) noexcept {
  const PoseCovariance c = with_noise(input.covariance, position_noise_, heading_noise_);
  const double yx = c[1][0] / c[0][0], hx = c[2][0] / c[0][0];
  // These bounds hold for every positive semidefinite matrix. They protect against others.
  const double y_variance = std::max(c[1][1] - yx * c[1][0], square(position_noise_));
  const double coupling = c[2][1] - hx * c[1][0], hy = coupling / y_variance;
  const double yaw_variance = std::max(c[2][2] - hx * c[2][0] - hy * coupling, square(heading_noise_));
  const double rows[3][3] = {{1, 0, 0}, {-yx, 1, 0}, {hy * yx - hx, -hy, 1}};
  const double variances[3] = {c[0][0], y_variance, yaw_variance};
  for (int i = 0; i < 3; ++i) {
    const double differences[3] = {input.pose.x - state_[x], input.pose.y - state_[y],
                                   maps::wrap_angle(input.pose.yaw - state_[yaw])};
    Vector row = Vector::Zero();
    double difference = 0;
    for (int j = 0; j < 3; ++j) {
      row[j] = rows[i][j];
      difference += row[j] * differences[j];
    }
    correct(row, difference, variances[i]);
  }
}

/// Compares the way that the wheels measure with that between the poses, at the end of each stretch whose
/// speed ends about as it began: then the wheels have slipped as much to either side. Neither the model nor
/// the commands take part, so their errors do not count as those of the wheels.
void StateObserver::learn_wheels(const ObserverInput& input) noexcept {
  const double heading = last_.pose.yaw + 0.5 * maps::wrap_angle(input.pose.yaw - last_.pose.yaw);
  const double c = std::cos(heading), s = std::sin(heading);
  poses_way_ += c * (input.pose.x - last_.pose.x) + s * (input.pose.y - last_.pose.y);
  wheels_way_ += 0.5 * (last_.speed + input.speed) * period_;
  stretch_time_ += period_;
  last_ = input;
  if (wheels_way_ < stretch) return;
  // The lower bound holds for every positive semidefinite matrix. It protects against others.
  const auto variance_along = [&](const ObserverInput& at) {
    const PoseCovariance pose = with_noise(at.covariance, position_noise_, heading_noise_);
    const double along = std::cos(at.pose.yaw), across = std::sin(at.pose.yaw);
    return std::max(
        along * along * pose[0][0] + 2 * along * across * pose[0][1] + across * across * pose[1][1],
        square(position_noise_) + 1e-6);
  };
  const double variance = (variance_along(stretch_begin_) + variance_along(input)) / square(wheels_way_);
  const double error = wheels_way_ / poses_way_ - 1;
  wheel_variance_ += square(wheel_drift);
  if (std::abs(input.speed - stretch_begin_.speed) < steady * stretch_time_ &&
      std::abs(error) < largest_wheel_error) {
    const double share = wheel_variance_ / (wheel_variance_ + variance);
    wheel_error_ += share * (error - wheel_error_);
    wheel_variance_ *= 1 - share;
  }
  begin_stretch(input);
}

void StateObserver::begin_stretch(const ObserverInput& input) noexcept {
  stretch_begin_ = last_ = input;
  poses_way_ = wheels_way_ = stretch_time_ = 0;
}

void StateObserver::update(const DynamicVehicleModel& model, const ObserverInput& measured,
                           double friction) noexcept {
  friction_ = friction;
  ObserverInput input = measured;
  input.speed /= 1 + wheel_error_;
  const bool missed = sent_since_ > 1;
  sent_since_ = 0;
  if (!known_ || missed || std::abs(input.speed) < slow) {
    if (known_) move(model, now_, -period_, 0);
    begin(model, input);
    begin_stretch(measured);
    known_ = true;
    return;
  }
  const double before = state_[speed];
  predict(model, input.imu);
  const double slip = wheel_slip * (state_[speed] - before) / period_ * state_[speed];
  const double turned = maps::wrap_angle(input.pose.yaw - state_[yaw]);
  if (!(std::hypot(input.pose.x - state_[x], input.pose.y - state_[y]) < reset_distance &&
        std::abs(turned) < reset_distance)) {
    begin_stretch(measured);
    return begin(model, input);
  }
  correct_pose(input);
  correct(Vector::Unit(speed), input.speed - state_[speed], square(speed_noise) + square(slip));
  learn_wheels(measured);
  if (input.imu)
    correct(Vector::Unit(yaw_rate) + Vector::Unit(bias),
            input.imu->yaw_rate - state_[yaw_rate] - state_[bias], square(gyro_noise));
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

}  // namespace slalom::vehicle::detail
