#include "slalom/vehicle/model/identification.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "slalom/maps/pose.hpp"
#include "vehicle/model/least_squares.hpp"

namespace slalom::vehicle {
namespace {

constexpr int parameters = 6;  // gain, offset, delay, time constant, wheelbase, understeer

/// The change of yaw from one sample to the next.
struct Turn {
  double begin = 0, end = 0;  ///< s
  double turned = 0;          ///< rad
  double speed = 0;           ///< m/s, mean of the two samples
  std::size_t sample = 0;     ///< index of the first of the two
  bool first = false;         ///< whether it is the first of a segment
  bool counts = false;        ///< whether the fit uses it
};

std::vector<Turn> turns_of(std::span<const DrivenSample> samples, double min_speed) {
  std::vector<Turn> turns;
  double segment_begin = 0;
  bool first = true;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const DrivenSample &a = samples[i], &b = samples[i + 1];
    const double dt = b.time - a.time;
    const double all =
        a.time + b.time + a.yaw + b.yaw + a.speed + b.speed + a.steer_command + a.x + b.x + a.y + b.y;
    if (!std::isfinite(all) || dt <= 0 || dt > detail::DriveLimits::gap) {
      first = true;
      continue;
    }
    Turn t{a.time, b.time, maps::wrap_angle(b.yaw - a.yaw), 0.5 * (a.speed + b.speed), i, first, false};
    if (first) segment_begin = a.time;
    first = false;
    t.counts = std::abs(t.speed) >= min_speed && a.time - segment_begin >= detail::DriveLimits::settling;
    turns.push_back(t);
  }
  return turns;
}

/// Moves the wheels towards `target` for `dt` (s). Returns the integral of their tangent (Simpson's rule).
double run(double& steer, double target, double lag, double dt) {
  const double half = std::exp(-0.5 * dt / lag);
  const double middle = target + (steer - target) * half, end = target + (steer - target) * half * half;
  const double integral = dt / 6 * (std::tan(steer) + 4 * std::tan(middle) + std::tan(end));
  steer = end;
  return integral;
}

/// The predicted changes of yaw minus the measured ones, one for each change that is used.
void predict(std::span<const DrivenSample> samples, const std::vector<Turn>& turns, std::span<const double> p,
             std::vector<double>& out) {
  out.clear();
  double steer = 0;
  std::size_t acting = 0;
  for (const Turn& t : turns) {
    if (t.first) {
      acting = t.sample;
      steer = p[0] * samples[acting].steer_command + p[1];
    }
    double at = t.begin, integral = 0;
    while (at < t.end - 1e-12) {
      // The command that acts now, and until when.
      while (acting < t.sample && samples[acting + 1].time + p[2] <= at + 1e-12) ++acting;
      const double next = acting < t.sample ? samples[acting + 1].time + p[2] : t.end;
      const double until = std::clamp(next, at + 1e-6, t.end);
      integral += run(steer, p[0] * samples[acting].steer_command + p[1], p[3], until - at);
      at = until;
    }
    if (t.counts) out.push_back(t.speed * integral / (p[4] + p[5] * t.speed * t.speed) - t.turned);
  }
}

/// The parameters; the wheelbase is not sought where it is given.
std::array<detail::FitParameter, parameters> fit_parameters(bool wheelbase_given) {
  return {{{0.05, 20, 1e-4},
           {-0.5, 0.5, 1e-5},
           {0, detail::DriveLimits::delay, 1e-4},
           {2e-3, 2, 1e-4},
           {0.02, 20, 1e-4, !wheelbase_given},
           {-0.02, 1, 1e-5}}};
}

void require_enough(std::span<const DrivenSample> samples, const std::vector<Turn>& turns) {
  int used = 0;
  double low = 1e9, high = -1e9;
  for (const Turn& t : turns) {
    if (!t.counts) continue;
    ++used;
    low = std::min(low, samples[t.sample].steer_command);
    high = std::max(high, samples[t.sample].steer_command);
  }
  if (used < detail::DriveLimits::samples)
    throw std::invalid_argument("identify: " + std::to_string(used) + " usable samples, must be at least " +
                                std::to_string(detail::DriveLimits::samples) + "; drive for longer");
  if (high - low < 0.1)
    throw std::invalid_argument("identify: the steering commands span " + std::to_string(high - low) +
                                " rad, must span at least 0.1 rad; drive curves to both sides");
}

double speed_scale(std::span<const DrivenSample> samples, const std::vector<Turn>& turns) {
  double by_pose = 0, by_speed = 0;
  // Over up to 0.25 s at a time, since the noise of single poses lengthens the distance. The chord is shorter
  // than the path in a curve, so stretches that begin with a turn of 0.05 rad or more are not used.
  for (std::size_t i = 0; i < turns.size();) {
    double distance = 0;
    std::size_t j = i;
    while (j < turns.size() && !(j > i && turns[j].first) && turns[j].end - turns[i].begin < 0.25) {
      distance += std::abs(turns[j].speed) * (turns[j].end - turns[j].begin);
      ++j;
    }
    if (j > i && turns[i].counts && std::abs(turns[i].turned) < 0.05) {
      const DrivenSample &a = samples[turns[i].sample], &b = samples[turns[j - 1].sample + 1];
      by_pose += std::hypot(b.x - a.x, b.y - a.y);
      by_speed += distance;
    }
    i = std::max(j, i + 1);
  }
  return by_speed > 0 ? by_pose / by_speed : 1;
}

}  // namespace

Identification identify(std::span<const DrivenSample> samples, const IdentificationOptions& options) {
  if (!(options.wheelbase >= 0) || !(options.min_speed > 0))
    throw std::invalid_argument("identify: wheelbase must be at least 0 m, min_speed above 0 m/s");
  const std::vector<Turn> turns = turns_of(samples, options.min_speed);
  require_enough(samples, turns);
  const bool given = options.wheelbase > 0;
  const auto sought = fit_parameters(given);
  const auto residuals = [&](std::span<const double> p, std::vector<double>& out) {
    predict(samples, turns, p, out);
  };
  detail::Fit best{.sum = INFINITY};
  for (const double delay : {0.0, 0.05, 0.1, 0.2}) {
    const detail::Fit fit =
        detail::least_squares(residuals, sought, {1, 0, delay, 0.08, given ? options.wheelbase : 0.33, 0.0});
    if (fit.sum < best.sum) best = fit;
  }
  Identification found;
  found.speed_scale = speed_scale(samples, turns);
  double rate = 0, rate_squares = 0, dt = 0;
  for (const Turn& t : turns) {
    if (!t.counts) continue;
    ++found.samples;
    rate += t.turned;
    rate_squares += t.turned * t.turned;
    dt += t.end - t.begin;
  }
  const double n = found.samples, variance = best.sum / std::max(1.0, n - parameters);
  found.residual = std::sqrt(best.sum / n) / (dt / n);
  found.explained = 1 - best.sum / std::max(1e-300, rate_squares - rate * rate / n);
  Identified* const values[parameters] = {&found.steering_gain, &found.steering_offset, &found.delay,
                                          &found.time_constant, &found.wheelbase,       &found.understeer};
  const std::vector<double> spread = detail::deviations(best, sought, variance);
  for (std::size_t i = 0; i < parameters; ++i) *values[i] = {best.values[i], spread[i]};
  return found;
}

}  // namespace slalom::vehicle
