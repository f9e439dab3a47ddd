#pragma once

#include <Eigen/Core>

#include "slalom/maps/imu_reading.hpp"
#include "slalom/vehicle/model/vehicle_model.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::vehicle::detail {

/// The readings of the sensors at one moment.
struct ObserverInput {
  maps::Pose pose;                  ///< pose of the rear axle, map frame
  double speed = 0;                 ///< m/s
  PoseCovariance covariance{};      ///< covariance of `pose`
  std::optional<ImuReading> imu{};  ///< mean over the last control period
};

/// Estimates the state of a car whose tyres slip, from pose, speed and, if there is one, an inertial
/// measurement unit. It is an extended Kalman filter over pose, speed, yaw rate, sideways velocity and the
/// gyro's bias (S. Thrun, W. Burgard, D. Fox, "Probabilistic Robotics" (2005), Table 3.3). The vehicle model
/// and the commands sent predict the state, and accelerometers share in the prediction of speed and sideways
/// velocity by the inverse of their variances. Derivatives are differences. Measured speeds are corrected by
/// the error of the wheels' size, which the way between poses shows.
///
/// Commands are sent once per control period; a speed takes effect after `latency`, a steering angle
/// `dead_time` later. Below 0.5 m/s, after a missed period and after a jump of the pose by more than 0.5 m or
/// 0.5 rad the filter restarts as a car whose tyres do not slip. An update neither allocates nor throws.
class StateObserver {
 public:
  /// All times in s; latency and dead time together at most 32 periods.
  StateObserver(const EstimationOptions& options, double period, double latency, double dead_time);

  /// Forgets everything.
  void reset() noexcept;

  /// Takes the measurements one control period after the last ones. Predictions assume this friction.
  void update(const DynamicVehicleModel& model, const ObserverInput& measured, double friction) noexcept;

  /// Records the command that is sent now. The next updates use it.
  void send(const Command& command) noexcept;

  /// Sets the times (s) after which speed and steering react to a command.
  void set_delays(double speed, double steering) noexcept {
    latency_ = speed;
    delay_ = std::max(speed, steering);
  }

  /// The state at the time of the measurements.
  const VehicleStart& now() const noexcept { return now_; }

  /// The state when the next command takes effect on the steering.
  VehicleStart ahead(const DynamicVehicleModel& model) const noexcept;
  /// The speed (m/s) when the next command takes effect on it.
  double speed_ahead(const DynamicVehicleModel& model) const noexcept;

 private:
  static constexpr int size = 7;  ///< x, y, yaw, speed, yaw rate, sideways velocity, bias of the gyro
  using Vector = Eigen::Matrix<double, size, 1>;
  using Matrix = Eigen::Matrix<double, size, size>;

  void begin(const DynamicVehicleModel& model, const ObserverInput& input) noexcept;
  void predict(const DynamicVehicleModel& model, const std::optional<ImuReading>& imu) noexcept;
  Matrix slopes(const DynamicVehicleModel& model, const Vector& before, double steer) const noexcept;
  void use_accelerometers(const ImuReading& imu, const Vector& before, Matrix& slope, Vector& noise) noexcept;
  void correct(const Vector& row, double difference, double variance) noexcept;
  void correct_pose(const ObserverInput& input) noexcept;
  void learn_wheels(const ObserverInput& input) noexcept;
  void begin_stretch(const ObserverInput& input) noexcept;
  void move(const DynamicVehicleModel& model, VehicleStart& car, double begin, double end) const noexcept;
  Vector moved(const DynamicVehicleModel& model, const Vector& from, double& steer) const noexcept;
  const Command& acting(double time, double delay) const noexcept;

  double position_noise_, heading_noise_;  ///< m, rad
  double period_, latency_, delay_;        ///< s
  double friction_ = 0;
  std::array<Command, 36> sent_;
  VehicleStart now_;
  Vector state_ = Vector::Zero();
  Matrix covariance_ = Matrix::Zero();
  double wheel_error_ = 0, wheel_variance_ = 0;  ///< share by which the wheels measure too much speed
  ObserverInput stretch_begin_, last_;           ///< ends of the stretch that `learn_wheels` compares
  double poses_way_ = 0, wheels_way_ = 0, stretch_time_ = 0;  ///< m, m, s of this stretch
  int sent_since_ = 0;                                        ///< commands since the last update
  bool known_ = false;
};

}  // namespace slalom::vehicle::detail
