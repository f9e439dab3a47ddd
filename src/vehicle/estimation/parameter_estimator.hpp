#pragma once

#include "slalom/maps/pose.hpp"
#include "slalom/vehicle/planner/planner.hpp"
#include "vehicle/estimation/hypothesis_bank.hpp"

namespace slalom::vehicle::detail {

/// The motion of the car, one control period after the last.
struct MeasuredMotion {
  maps::Pose pose;      ///< pose of the rear axle, map frame
  double speed = 0;     ///< m/s
  double yaw_rate = 0;  ///< rad/s, of the observer
  double slip = 0;      ///< rad, of the observer
};

/// Estimates friction, gain, offset and delay of the steering of a car while it drives.
///
/// Each combination of values on a grid is a hypothesis: 16 frictions from 0.25 to 1.5, 5 gains from 0.85 to
/// 1.15 and 9 delays from 0 to 0.2 s. In every control period, the dynamics predict the last 0.4 s (the
/// window) for all hypotheses at once, in SIMD lanes. A prediction starts at the measured
/// state, uses the measured speed, and delays and scales the sent commands by the hypothesis. The logarithm
/// of a hypothesis' weight falls by
///
///     s (period / window) / 2 * ((lateral error / lateral_noise)^2 + (yaw error / 0.02 rad)^2)
///
/// with the errors of the predicted pose at the end, and s = min(1, (a / 1.5 m/s^2)^2) with the
/// root mean square a of the lateral acceleration in the window. The factor allows for the overlap of
/// successive windows. Errors beyond five deviations count as five, so that a collision or a jump of the
/// localisation decides nothing. The estimator forgets within 2 s of turning. On a straight line it can learn
/// nothing about the tyres and forgets nothing either: there it learns the offset of the steering, from the
/// error of the yaw that the given values predict. The prior consists of independent normal distributions
/// around the given values; that of the friction is for its logarithm.
///
/// Where the car starts from rest, the time until it moves shows a delay that is longer than the given one,
/// before the first turn does.
///
/// The means are those of the posterior; before the first turn they are the given values.
/// `cautious_friction` is a quantile of the posterior, never above the given friction. The quantile rises
/// with the confidence from a fifth of `friction_quantile` to all of it.
///
/// The time of an update does not depend on data. It neither allocates nor throws.
class ParameterEstimator {
 public:
  /// `friction` and `delay` (s) are the given values; `period` (s) is the control period.
  ParameterEstimator(const SingleTrackDynamics& dynamics, const EstimationOptions& options, double friction,
                     double delay, double period);

  /// Forgets everything.
  void reset() noexcept;

  /// Records the command that is sent now.
  void send(const Command& command) noexcept;

  /// Learns from the motion of the last control period.
  const ParameterEstimate& update(const MeasuredMotion& now) noexcept;

  /// The present estimate.
  const ParameterEstimate& estimate() const noexcept { return estimate_; }
  /// The time (s) that the car took to move at its last start, if that was longer than the given delay; or 0.
  double start_delay() const noexcept { return start_delay_; }

 private:
  static constexpr int frictions = HypothesisGrid::frictions, gains = HypothesisGrid::gains,
                       delays = HypothesisGrid::delays;
  static constexpr int kept = 64;  ///< control periods of history

  struct Moment {
    MeasuredMotion motion;
    std::array<double, delays> angle{};  ///< rad, of the wheels at gain 1, for each delay
  };

  /// Mean and standard deviation of a distribution.
  struct Moments {
    double mean = 0, deviation = 0;
    template <std::size_t n, class At>
    static Moments of(const std::array<double, n>& share, double step, At&& at) noexcept;
  };

  /// Moments of the prior alone.
  struct Prior {
    Moments logarithm, gain, delay;  ///< logarithm of the friction; gain; delay, s
  };

  const Moment& ago(int periods) const noexcept;
  void turn_wheels(Moment& next) const noexcept;
  Stretch last_stretch() const noexcept;
  double turning_share() const noexcept;
  void watch_start(double speed) noexcept;
  void weigh() noexcept;
  void learn_offset(double straightness) noexcept;
  void summarise() noexcept;
  double log_quantile(const std::array<double, frictions>& shares, double quantile) const noexcept;
  bool continues() const noexcept;

  SingleTrackDynamics dynamics_;
  HypothesisGrid grid_;
  double friction_quantile_, lateral_noise_;
  double friction_, delay_, period_;
  double wheelbase_;       ///< m
  std::size_t given_ = 0;  ///< index of the hypothesis nearest to the given values
  int window_;             ///< control periods
  std::array<Moment, kept> history_;
  std::array<double, kept> sent_{};
  int newest_ = 0, moments_ = 0;
  int start_ = -1;  ///< control periods since a car at rest was told to drive; 0: at rest, -1: driving
  double start_way_ = 0, early_delay_ = 0, start_delay_ = 0;  ///< m, the way since then; s, s
  std::vector<double> log_prior_;                 ///< logarithms of weights, [delay][gain][friction]
  std::vector<double> evidence_;                  ///< logarithms of likelihoods
  std::vector<float> lateral_error_, yaw_error_;  ///< m, rad
  Prior prior_;
  ParameterEstimate estimate_;
};

}  // namespace slalom::vehicle::detail
