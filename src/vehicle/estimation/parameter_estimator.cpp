#include "vehicle/estimation/parameter_estimator.hpp"

#include "slalom/core/math.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::vehicle::detail {
namespace {

constexpr double lowest_friction = 0.25, highest_friction = 1.5;
constexpr double lowest_gain = 0.85, highest_gain = 1.15;
constexpr double max_delay = 0.2;        // s
constexpr double friction_spread = 0.5;  // standard deviation of the friction's logarithm, in advance
constexpr double unknown_share = 0.2;    // factor of the quantile before anything is known
constexpr double gain_spread = 0.05;     // standard deviation, in advance
constexpr double delay_spread = 0.06;    // s, standard deviation, in advance
constexpr double window_time = 0.4;      // s of driving that each hypothesis predicts
constexpr double memory = 2.0;           // s of turning after which what was learned is forgotten
constexpr double yaw_noise = 0.02;       // rad, deviation of a predicted heading
constexpr double slowest = 1.0;          // m/s, below it tyres hardly slip
constexpr double standing = 0.05;        // m/s
constexpr double start_noise = 0.03;     // s, deviation of the delay that a start shows
constexpr double turning = 3.0;  // m/s^2, lateral acceleration from which old evidence fades at the full rate
constexpr double offset_time = 0.5;     // s of straight driving within which the offset is learned
constexpr double largest_offset = 0.1;  // rad
constexpr double straight = 0.05;       // rad, angle of the wheels up to which a way counts as straight
constexpr double farthest = 0.5;        // m or rad between poses: a jump of the localisation
constexpr double largest_error = 5;     // deviations
constexpr double strongest = 15;        // m/s^2, of a measured acceleration

double ratio() noexcept {
  return std::log(highest_friction / lowest_friction) / (HypothesisGrid::frictions - 1);
}
double friction_at(int i) noexcept {
  return lowest_friction * std::exp(ratio() * i);
}
double gain_at(int i) noexcept {
  return lowest_gain + (highest_gain - lowest_gain) * i / (HypothesisGrid::gains - 1);
}
double delay_at(int i) noexcept {
  return max_delay * i / (HypothesisGrid::delays - 1);
}

}  // namespace

/// Returns mean and deviation of a value over a marginal distribution on a grid. Each grid point stands for
/// the interval of length `step` around it.
template <std::size_t n, class At>
ParameterEstimator::Moments ParameterEstimator::Moments::of(const std::array<double, n>& share, double step,
                                                            At&& at) noexcept {
  Moments made;
  for (std::size_t i = 0; i < n; ++i) made.mean += share[i] * at(static_cast<int>(i));
  double variance = step * step / 12;
  for (std::size_t i = 0; i < n; ++i) variance += share[i] * square(at(static_cast<int>(i)) - made.mean);
  made.deviation = std::sqrt(variance);
  return made;
}

ParameterEstimator::ParameterEstimator(const SingleTrackDynamics& dynamics, const EstimationOptions& options,
                                       double friction, double delay, double period)
    : dynamics_(dynamics),
      friction_quantile_(options.friction_quantile),
      lateral_noise_(options.lateral_noise),
      friction_(friction),
      delay_(delay),
      period_(period),
      wheelbase_(dynamics.wheelbase()),
      window_(std::clamp(saturate_cast<int>(std::round(window_time / period)), 2, Stretch::max_steps)),
      log_prior_(HypothesisGrid::count),
      evidence_(log_prior_.size()),
      lateral_error_(log_prior_.size()),
      yaw_error_(log_prior_.size()) {
  for (int g = 0; g < gains; ++g) grid_.gain[g] = static_cast<float>(gain_at(g));
  for (int f = 0; f < frictions; ++f) grid_.friction[f] = static_cast<float>(friction_at(f));
  std::size_t at = 0;
  for (int d = 0; d < delays; ++d)
    for (int g = 0; g < gains; ++g)
      for (int f = 0; f < frictions; ++f)
        log_prior_[at++] =
            -0.5 * (square((delay_at(d) - delay_) / delay_spread) + square((gain_at(g) - 1) / gain_spread) +
                    square(std::log(friction_at(f) / friction_) / friction_spread));
  given_ =
      static_cast<std::size_t>(std::max_element(log_prior_.begin(), log_prior_.end()) - log_prior_.begin());
  reset();
}

void ParameterEstimator::reset() noexcept {
  history_.fill({});
  sent_.fill(0);
  newest_ = moments_ = 0;
  start_ = -1;
  start_delay_ = 0;
  std::fill(evidence_.begin(), evidence_.end(), 0.0);
  estimate_.steering_offset = 0;
  summarise();
}

void ParameterEstimator::send(const Command& command) noexcept {
  for (std::size_t i = sent_.size() - 1; i > 0; --i) sent_[i] = sent_[i - 1];
  sent_[0] = command.steer;
  if (start_ == 0 && command.speed > standing) start_ = 1;
}

const ParameterEstimator::Moment& ParameterEstimator::ago(int periods) const noexcept {
  return history_[(newest_ + kept - periods) % kept];
}

/// Computes the wheels' angle one period later, for each delay. The newest command was sent at the beginning
/// of the period; two commands act in it, one after the other.
void ParameterEstimator::turn_wheels(Moment& next) const noexcept {
  const auto sent = [&](int i) { return sent_[std::min(i, kept - 1)]; };
  for (int d = 0; d < delays; ++d) {
    const double periods = delay_at(d) / period_;
    const int whole = saturate_cast<int>(periods + 1e-6);
    const double older_share = std::max(0.0, periods - whole);
    double angle = ago(0).angle[d];
    angle = dynamics_.lagged(angle, sent(whole + 1), older_share * period_);
    angle = dynamics_.lagged(angle, sent(whole), (1 - older_share) * period_);
    next.angle[d] = angle;
  }
}

bool ParameterEstimator::continues() const noexcept {
  for (int k = 0; k < window_; ++k) {
    const MeasuredMotion &after = ago(k).motion, &before = ago(k + 1).motion;
    const double moved = std::hypot(after.pose.x - before.pose.x, after.pose.y - before.pose.y);
    if (before.speed < slowest || after.speed < slowest ||
        std::abs(moved - before.speed * period_) > farthest ||
        std::abs(maps::wrap_angle(after.pose.yaw - before.pose.yaw)) > farthest)
      return false;
  }
  return true;
}

const ParameterEstimate& ParameterEstimator::update(const MeasuredMotion& now) noexcept {
  Moment next{.motion = now};
  turn_wheels(next);
  newest_ = (newest_ + 1) % kept;
  history_[newest_] = next;
  moments_ = std::min(moments_ + 1, kept);
  watch_start(now.speed);
  if (moments_ > window_ + 2 && continues()) {
    weigh();
    summarise();
  }
  return estimate_;
}

/// Returns the motion within the window, relative to the pose at its begin.
Stretch ParameterEstimator::last_stretch() const noexcept {
  const MeasuredMotion &begin = ago(window_).motion, &end = ago(0).motion;
  const maps::Point moved = maps::inverse_transform(begin.pose, {end.pose.x, end.pose.y});
  Stretch stretch;
  stretch.steps = window_;
  stretch.period = static_cast<float>(period_);
  stretch.offset = static_cast<float>(estimate_.steering_offset);
  stretch.yaw_rate = static_cast<float>(begin.yaw_rate);
  stretch.lateral = static_cast<float>(begin.speed * std::sin(begin.slip));
  stretch.x = static_cast<float>(moved.x);
  stretch.y = static_cast<float>(moved.y);
  stretch.yaw = static_cast<float>(maps::wrap_angle(end.pose.yaw - begin.pose.yaw));
  for (int k = 0; k <= window_; ++k) {
    const auto row = static_cast<std::size_t>(k);
    const Moment& moment = ago(window_ - k);
    stretch.speed[row] = static_cast<float>(moment.motion.speed);
    for (std::size_t d = 0; d < delays; ++d) stretch.angle[row][d] = static_cast<float>(moment.angle[d]);
    if (k == window_) break;
    const int before = window_ - k + 1, after = std::max(window_ - k - 2, 0);
    const double gained = ago(after).motion.speed - ago(before).motion.speed;
    stretch.acceleration[row] =
        static_cast<float>(std::clamp(gained / ((before - after) * period_), -strongest, strongest));
  }
  return stretch;
}

/// Returns how much the car turned within the window, 0 to 1.
double ParameterEstimator::turning_share() const noexcept {
  double mean_square = 0;  // m^2/s^4, of the lateral acceleration
  for (int k = window_; k >= 0; --k)
    mean_square += square(ago(k).motion.speed * ago(k).motion.yaw_rate) / (window_ + 1);
  return std::min(1.0, mean_square / square(turning));
}

/// Learns how long the car took to move, at the speed `slowest`: if the speed rose evenly, it drove for twice
/// its way over its speed, also at half of it. One that moves at once says nothing of a servo that lags.
void ParameterEstimator::watch_start(double speed) noexcept {
  if (start_ <= 0) {
    start_ = std::abs(speed) < standing ? 0 : -1;
    start_way_ = early_delay_ = 0;
    return;
  }
  start_way_ += period_ * speed;
  const double delay = (start_ + 1) * period_ - 2 * start_way_ / speed;
  if (2 * speed < slowest) early_delay_ = delay;
  if (++start_; speed < slowest) return;
  start_ = -1;
  if (!(delay > delay_ && delay < max_delay && std::abs(delay - early_delay_) < start_noise)) return;
  start_delay_ = delay;
  for (int i = 0; i < HypothesisGrid::count; ++i)
    evidence_[i] -= 0.5 * square((delay_at(i / (gains * frictions)) - delay) / start_noise);
  summarise();
}

/// Updates the evidence for each hypothesis by the errors of its prediction of the window.
void ParameterEstimator::weigh() noexcept {
  predict_all(dynamics_, grid_, last_stretch(), lateral_error_.data(), yaw_error_.data());
  const double turned_share = turning_share();
  const double remembered = std::exp(-period_ / memory * turned_share);
  const double evidence_share = std::min(4 * turned_share, 1.0);
  const double share = 0.5 * evidence_share / window_, most = square(largest_error);
  double best = -INFINITY;
  for (std::size_t i = 0; i < evidence_.size(); ++i) {
    const double aside = square(lateral_error_[i] / lateral_noise_);
    const double turned = square(yaw_error_[i] / yaw_noise);
    // A prediction that diverges may have an error that is not a number, which counts as the largest.
    const double error = (aside < most ? aside : most) + (turned < most ? turned : most);
    evidence_[i] = remembered * evidence_[i] - share * error;
    best = std::max(best, evidence_[i]);
  }
  for (double& each : evidence_) each -= best;
  learn_offset(1 - evidence_share);
}

/// Moves the offset of the steering towards the one that explains the yaw at the end of the window, the less
/// the more the car turns: there gain and friction decide.
void ParameterEstimator::learn_offset(double straightness) noexcept {
  const double way = ago(0).motion.speed * window_ * period_;  // m
  const double turned = maps::wrap_angle(ago(0).motion.pose.yaw - ago(window_).motion.pose.yaw);
  const double share = straightness - square(turned * wheelbase_ / way / straight);
  const double missing = -static_cast<double>(yaw_error_[given_]) * wheelbase_ / way;
  if (!(share > 0 && std::abs(missing) < largest_offset)) return;
  double& offset = estimate_.steering_offset;
  offset = std::clamp(offset + share * period_ / offset_time * missing, -largest_offset, largest_offset);
}

/// Returns the quantile of the friction's logarithm, whose density is constant around each grid point.
double ParameterEstimator::log_quantile(const std::array<double, frictions>& shares,
                                        double quantile) const noexcept {
  double below = 0;
  for (int f = 0; f < frictions; ++f) {
    const double share = shares[f];
    if (below + share >= quantile)
      return std::log(friction_at(f)) + ratio() * ((quantile - below) / share - 0.5);
    below += share;
  }
  return std::log(highest_friction);
}

void ParameterEstimator::summarise() noexcept {
  std::array<double, frictions> of_friction{};
  std::array<double, gains> of_gain{};
  std::array<double, delays> of_delay{};
  double best = -INFINITY, total = 0;
  for (std::size_t i = 0; i < log_prior_.size(); ++i) best = std::max(best, log_prior_[i] + evidence_[i]);
  std::size_t at = 0;
  for (std::size_t d = 0; d < delays; ++d)
    for (std::size_t g = 0; g < gains; ++g)
      for (std::size_t f = 0; f < frictions; ++f, ++at) {
        const double weight = std::exp(log_prior_[at] + evidence_[at] - best);
        of_friction[f] += weight;
        of_gain[g] += weight;
        of_delay[d] += weight;
        total += weight;
      }
  for (double& each : of_friction) each /= total;
  for (double& each : of_gain) each /= total;
  for (double& each : of_delay) each /= total;

  const auto log_friction_at = [](int i) { return std::log(friction_at(i)); };
  const Moments logarithm = Moments::of(of_friction, ratio(), log_friction_at);
  const Moments gain = Moments::of(of_gain, (highest_gain - lowest_gain) / (gains - 1), gain_at);
  const Moments delay = Moments::of(of_delay, max_delay / (delays - 1), delay_at);
  if (moments_ == 0) prior_ = {logarithm, gain, delay};
  // The grid cuts the prior off, so the mean of the prior is not the given value. Estimates therefore begin
  // at the given value and move by what has been learned.
  const auto learned = [](const Moments& now, const Moments& before) {
    return std::clamp(1 - square(now.deviation / before.deviation), 0.0, 1.0);
  };
  const auto shifted = [](const Moments& now, const Moments& before, double share, double given) {
    return now.mean + (1 - share) * (given - before.mean);
  };
  const double given = std::log(friction_);
  estimate_.confidence = learned(logarithm, prior_.logarithm);
  estimate_.friction = std::exp(shifted(logarithm, prior_.logarithm, estimate_.confidence, given));
  estimate_.friction_deviation = estimate_.friction * logarithm.deviation;
  estimate_.steering_gain = shifted(gain, prior_.gain, learned(gain, prior_.gain), 1);
  estimate_.steering_gain_deviation = gain.deviation;
  estimate_.delay = shifted(delay, prior_.delay, learned(delay, prior_.delay), delay_);
  estimate_.delay_deviation = delay.deviation;
  const double quantile = friction_quantile_ * (unknown_share + (1 - unknown_share) * estimate_.confidence);
  estimate_.cautious_friction = std::min(std::exp(log_quantile(of_friction, quantile)), friction_);
}

}  // namespace slalom::vehicle::detail
