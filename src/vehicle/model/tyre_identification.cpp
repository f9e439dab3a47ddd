#include "slalom/vehicle/model/tyre_identification.hpp"

#include <array>

#include "slalom/core/gravity.hpp"
#include "slalom/core/math.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/vehicle/model/single_track_dynamics.hpp"
#include "vehicle/model/least_squares.hpp"

namespace slalom::vehicle {
namespace {

constexpr double window_length = 0.2;        // s
constexpr double longest_step = 0.005;       // s of the prediction
constexpr double largest_acceleration = 15;  // m/s^2
constexpr double outlier = 5;                // deviations
constexpr double first_deviation = 0.01;     // rad and m, before the first fit

/// The parameters by their index.
struct At {
  enum : std::size_t { friction, front, rear, gain, offset, delay, lag, count };
};
/// The least and the largest value of each, and the step of derivatives by it.
constexpr std::array<detail::FitParameter, At::count> tyre_parameters{{{0.1, 2.5, 1e-4},
                                                                       {0.5, 100, 1e-3},
                                                                       {0.5, 100, 1e-3},
                                                                       {0.3, 3, 1e-4},
                                                                       {-0.3, 0.3, 1e-5},
                                                                       {0, detail::DriveLimits::delay, 1e-4},
                                                                       {2e-3, 1, 1e-4}}};

/// The drive from one sample to the next.
struct SampleInterval {
  std::size_t sample = 0;            ///< index of the first of the two
  double begin = 0, end = 0;         ///< s
  double speed = 0, next_speed = 0;  ///< m/s
  double acceleration = 0;           ///< m/s^2
  bool first = false;                ///< whether it is the first of a segment
};

/// A stretch that is compared with the poses.
struct Window {
  std::size_t begin = 0, end = 0;   ///< intervals, `end` the one after the last
  double turned = 0;                ///< rad, as measured
  double sideways = 0;              ///< m, as measured, in the frame of the pose at the begin
  double lateral_acceleration = 0;  ///< m/s^2
};

bool is_usable(const DrivenSample& s) {
  return std::isfinite(s.time + s.x + s.y + s.yaw + s.speed + s.steer_command);
}

/// The slope of the speed over up to two samples to either side.
double acceleration_at(std::span<const DrivenSample> samples, std::size_t i) {
  std::size_t low = i, high = i + 1;
  const auto joined = [&](std::size_t a) {
    const double dt = samples[a + 1].time - samples[a].time;
    return is_usable(samples[a]) && is_usable(samples[a + 1]) && dt > 0 && dt <= detail::DriveLimits::gap;
  };
  for (int k = 0; k < 2 && low > 0 && joined(low - 1); ++k) --low;
  for (int k = 0; k < 2 && high + 1 < samples.size() && joined(high); ++k) ++high;
  const double slope = (samples[high].speed - samples[low].speed) / (samples[high].time - samples[low].time);
  return std::clamp(slope, -largest_acceleration, largest_acceleration);
}

std::vector<SampleInterval> intervals_of(std::span<const DrivenSample> samples, double min_speed) {
  std::vector<SampleInterval> intervals;
  bool first = true;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const DrivenSample &a = samples[i], &b = samples[i + 1];
    const double dt = b.time - a.time;
    if (!is_usable(a) || !is_usable(b) || dt <= 0 || dt > detail::DriveLimits::gap ||
        std::min(a.speed, b.speed) < min_speed) {
      first = true;
      continue;
    }
    intervals.push_back({i, a.time, b.time, a.speed, b.speed, acceleration_at(samples, i), first});
    first = false;
  }
  return intervals;
}

std::vector<Window> windows_of(std::span<const DrivenSample> samples,
                               const std::vector<SampleInterval>& intervals) {
  std::vector<Window> windows;
  double segment_begin = 0;
  for (std::size_t i = 0; i < intervals.size();) {
    if (intervals[i].first) segment_begin = intervals[i].begin;
    std::size_t end = i + 1;
    while (end < intervals.size() && !intervals[end].first &&
           intervals[end - 1].end - intervals[i].begin < window_length - 1e-9)
      ++end;
    const double duration = intervals[end - 1].end - intervals[i].begin;
    if (duration >= window_length - 1e-9 &&
        intervals[i].begin - segment_begin >= detail::DriveLimits::settling) {
      const DrivenSample &a = samples[intervals[i].sample], &b = samples[intervals[end - 1].sample + 1];
      const double turned = maps::wrap_angle(b.yaw - a.yaw);
      windows.push_back({i, end, turned, maps::inverse_transform({a.x, a.y, a.yaw}, {b.x, b.y}).y,
                         0.5 * (a.speed + b.speed) * turned / duration});
    }
    i = end;
  }
  return windows;
}

/// The predictions of a drive with given parameters.
class Drive {
 public:
  Drive(std::span<const DrivenSample> samples, const PathTrackingOptions& car, const SingleTrackOptions& own,
        double min_speed)
      : samples_(samples),
        car_(car),
        own_(own),
        intervals_(intervals_of(samples, min_speed)),
        windows_(windows_of(samples, intervals_)) {}

  std::vector<Window>& windows() { return windows_; }

  /// Predicted minus measured change of yaw and sideways displacement of every window, over these deviations.
  void residuals(std::span<const double> p, double yaw_deviation, double sideways_deviation,
                 std::vector<double>& out) const {
    SingleTrackOptions own = own_;
    own.friction = p[At::friction];
    own.cornering_front = p[At::front];
    own.cornering_rear = p[At::rear];
    const SingleTrackDynamics dynamics(car_, own);
    out.clear();
    SingleTrackState<double> s{};
    maps::Pose begin;
    std::size_t acting = 0, next = 0;
    double drag = 0;
    for (std::size_t i = 0; i < intervals_.size() && next < windows_.size(); ++i) {
      const SampleInterval& interval = intervals_[i];
      if (interval.first) {
        acting = interval.sample;
        s = {};
        drag = 0;
        s.steer = p[At::gain] * samples_[acting].steer_command + p[At::offset];
        s.yaw_rate = interval.speed * std::tan(s.steer) / car_.wheelbase();
        s.lateral = s.yaw_rate * car_.rear_length;
      }
      const Window& compared = windows_[next];
      if (i == compared.begin) begin = {s.x, s.y, s.yaw};
      advance(s, interval, p, dynamics, acting, drag);
      if (i + 1 < compared.end) continue;
      const double sideways = maps::inverse_transform(begin, {s.x, s.y}).y;
      out.push_back((s.yaw - begin.yaw - compared.turned) / yaw_deviation);
      out.push_back((sideways - compared.sideways) / sideways_deviation);
      ++next;
    }
  }

 private:
  /// Moves the car from one sample to the next. `drag` is the acceleration (m/s^2) by tyres that slip.
  void advance(SingleTrackState<double>& s, const SampleInterval& interval, std::span<const double> p,
               const SingleTrackDynamics& dynamics, std::size_t& acting, double& drag) const {
    const double duration = interval.end - interval.begin;
    const int pieces = std::max(1, saturate_cast<int>(std::ceil(duration / longest_step - 1e-9)));
    const double dt = duration / pieces;
    for (int k = 0; k < pieces; ++k) {
      const double time = interval.begin + k * dt;
      s.speed = interval.speed + (interval.next_speed - interval.speed) * k / pieces;
      const double angle = servo(s.steer, time, time + dt, interval.sample, p, acting);
      // The gain of the speed is the motor's force less that of tyres that slip.
      const double motor = interval.acceleration - drag;
      const double before = s.speed;
      s = dynamics.advance(s, angle, motor, p[At::friction], dt);
      drag = std::clamp((s.speed - before) / dt - motor, -largest_acceleration, 0.0);
    }
  }

  /// The wheels' angle at `end` (s), which follows the delayed commands with a first-order lag.
  double servo(double angle, double begin, double end, std::size_t newest, std::span<const double> p,
               std::size_t& acting) const {
    for (double at = begin; at < end - 1e-12;) {
      while (acting < newest && samples_[acting + 1].time + p[At::delay] <= at + 1e-12) ++acting;
      const double change = acting < newest ? samples_[acting + 1].time + p[At::delay] : end;
      const double until = std::clamp(change, at + 1e-6, end);
      const double target = p[At::gain] * samples_[acting].steer_command + p[At::offset];
      angle = target + (angle - target) * std::exp(-(until - at) / p[At::lag]);
      at = until;
    }
    return angle;
  }

  std::span<const DrivenSample> samples_;
  PathTrackingOptions car_;
  SingleTrackOptions own_;
  std::vector<SampleInterval> intervals_;
  std::vector<Window> windows_;
};

struct Deviations {
  double yaw = 0, sideways = 0;  ///< rad, m
};

/// Root mean squares of residuals that were divided by `before`.
Deviations spread(const std::vector<double>& residuals, const Deviations& before) {
  Deviations found;
  for (std::size_t k = 0; k + 1 < residuals.size(); k += 2) {
    found.yaw += square(residuals[k]);
    found.sideways += square(residuals[k + 1]);
  }
  const double n = std::max(1.0, 0.5 * static_cast<double>(residuals.size()));
  return {before.yaw * std::sqrt(found.yaw / n), before.sideways * std::sqrt(found.sideways / n)};
}

void require_windows(std::span<const DrivenSample> samples, const std::vector<Window>& windows) {
  if (windows.size() < detail::DriveLimits::windows)
    throw std::invalid_argument("identify: " + std::to_string(windows.size()) +
                                " windows of 0.2 s are usable, must be at least " +
                                std::to_string(detail::DriveLimits::windows) + "; drive for longer");
  double low = 1e9, high = -1e9;
  for (const DrivenSample& s : samples)
    if (is_usable(s)) low = std::min(low, s.steer_command), high = std::max(high, s.steer_command);
  if (high - low < 0.1)
    throw std::invalid_argument("identify: the steering commands span " + std::to_string(high - low) +
                                " rad, must span at least 0.1 rad; drive curves to both sides");
}

/// The best fit from several starts.
detail::Fit best_fit(const Drive& drive, const Deviations& deviations,
                     std::span<const std::array<double, At::count>> starts) {
  const auto residuals = [&](std::span<const double> p, std::vector<double>& out) {
    drive.residuals(p, deviations.yaw, deviations.sideways, out);
  };
  detail::Fit best{.sum = INFINITY};
  for (const auto& start : starts) {
    const detail::Fit found = detail::least_squares(residuals, tyre_parameters, {start.begin(), start.end()});
    if (found.sum < best.sum) best = found;
  }
  if (!std::isfinite(best.sum))
    throw std::invalid_argument(
        "identify: no prediction of this drive is finite; check mass, inertia and lengths "
        "of the car");
  return best;
}

double grip_used(std::vector<Window> windows, double grip) {
  const auto at = windows.begin() + static_cast<std::ptrdiff_t>(windows.size() * 19 / 20);
  std::nth_element(windows.begin(), at, windows.end(), [](const Window& a, const Window& b) {
    return std::abs(a.lateral_acceleration) < std::abs(b.lateral_acceleration);
  });
  return std::abs(at->lateral_acceleration) / grip;
}

}  // namespace

TyreIdentification identify_tyres(std::span<const DrivenSample> samples, const PathTrackingOptions& car,
                                  const SingleTrackOptions& own, const IdentificationOptions& options) {
  if (!(options.min_speed > 0)) throw std::invalid_argument("identify: min_speed must be above 0 m/s");
  Drive drive(samples, car, own, options.min_speed);
  require_windows(samples, drive.windows());
  std::vector<std::array<double, At::count>> starts;
  for (const double share : {0.4, 0.7, 1.0})
    for (const double wait : {0.02, 0.08})
      starts.push_back({share * own.friction, own.cornering_front, own.cornering_rear, 1, 0, wait, 0.05});
  Deviations deviations{first_deviation, first_deviation};
  detail::Fit best = best_fit(drive, deviations, starts);

  std::vector<double> residuals;
  drive.residuals(best.values, deviations.yaw, deviations.sideways, residuals);
  deviations = spread(residuals, deviations);
  drive.residuals(best.values, deviations.yaw, deviations.sideways, residuals);
  std::vector<Window> kept;
  for (std::size_t k = 0; k < drive.windows().size(); ++k)
    if (std::abs(residuals[2 * k]) < outlier && std::abs(residuals[2 * k + 1]) < outlier)
      kept.push_back(drive.windows()[k]);
  drive.windows() = std::move(kept);
  require_windows(samples, drive.windows());
  std::array<double, At::count> found{};
  std::copy(best.values.begin(), best.values.end(), found.begin());
  best = best_fit(drive, deviations, {&found, 1});

  drive.residuals(best.values, deviations.yaw, deviations.sideways, residuals);
  const double n = static_cast<double>(residuals.size());
  const auto widths =
      detail::deviations(best, tyre_parameters, best.sum / std::max(1.0, n - static_cast<double>(At::count)));
  const auto identified = [&](std::size_t i) { return Identified{best.values[i], widths[i]}; };
  const Deviations rest = spread(residuals, deviations);
  return {identified(At::friction),
          identified(At::front),
          identified(At::rear),
          identified(At::gain),
          identified(At::offset),
          identified(At::delay),
          identified(At::lag),
          rest.yaw,
          rest.sideways,
          grip_used(drive.windows(), best.values[At::friction] * gravity),
          static_cast<int>(drive.windows().size())};
}

}  // namespace slalom::vehicle
