#include "slalom/evaluation/race.hpp"

namespace slalom::evaluation {
namespace {

constexpr double rounding = 1e-9;  // excess that a profile at the limit may have

/// The least value (first, sorted) such that those up to it have at least `share` of the weight (second).
double weighted_percentile(const std::vector<std::pair<double, double>>& weighted, double total,
                           double share) {
  double sum = 0;
  for (const auto& [value, weight] : weighted) {
    sum += weight;
    if (sum >= share * total) return value;
  }
  return weighted.back().first;
}

/// The motion from which the accelerations of a car are computed.
struct Motion {
  double distance = 0, time = 0;    ///< m since the standing start, s
  double speed = 0, direction = 0;  ///< m/s, rad, of the velocity
};

Motion motion_of(const sim::World& world) {
  const sim::Observation seen = world.observe(0);
  return {world.laps(0)->progress(), seen.time, seen.speed, seen.pose.yaw + seen.slip};
}

/// The mean acceleration between two moments, along and across the direction in the middle of them.
RacingSample sample_between(const Motion& before, const Motion& now) {
  const double half_turn = 0.5 * maps::wrap_angle(now.direction - before.direction);
  const double duration = now.time - before.time;
  return {.distance = now.distance,
          .time = now.time,
          .speed = now.speed,
          .longitudinal = (now.speed - before.speed) * std::cos(half_turn) / duration,
          .lateral = (now.speed + before.speed) * std::sin(half_turn) / duration};
}

/// Times the laps of a drive, beginning at a standing start.
class LapClock {
 public:
  LapClock(const LapDrive& drive, std::uint64_t seed, bool flying)
      : length_(drive.setup().length()),
        timeout_(drive.setup().timeout()),
        seed_(seed),
        flying_(flying),
        before_(motion_of(drive.world())) {
    begin_lap({.distance = 0, .time = 0});
  }

  /// A control step with progress and time of the present lap.
  ControlStep of_lap(ControlStep step) const {
    step.progress = std::clamp(lap_.samples.back().distance / length_, 0.0, 1.0);
    step.time -= begin_.time;
    return step;
  }

  /// Adds the control period that has been driven. Call it after each one.
  void moved(const LapDrive& drive) {
    const Motion now = motion_of(drive.world());
    add(sample_between(before_, now), drive.collisions() > 0);
    before_ = now;
  }

  /// Returns the lap that has ended since the last call, if any.
  std::optional<RacingLap> take_ended() { return std::exchange(ended_, std::nullopt); }
  /// Whether another lap follows without a standing start.
  bool goes_on() const { return goes_on_; }

 private:
  /// Begins a lap at a sample whose distance and time are those since the standing start.
  void begin_lap(RacingSample at) {
    lap_ = {};
    lap_.standing = at.distance == 0;
    lap_.seed = seed_;
    begin_ = at;
    at.distance = at.time = 0;
    lap_.samples.push_back(at);
  }

  void end_lap(RacingEnd end) {
    lap_.end = end;
    lap_.sector = sector_times(lap_.samples, length_);
    ended_ = std::move(lap_);
  }

  /// Adds a sample whose distance and time are those since the standing start.
  void add(RacingSample sample, bool collided) {
    sample.distance -= begin_.distance;
    sample.time -= begin_.time;
    lap_.samples.push_back(sample);
    if (collided) return end_early(RacingEnd::collision);
    if (sample.distance >= length_) return cross_line();
    if (sample.time > timeout_) end_early(RacingEnd::timeout);
  }

  void end_early(RacingEnd end) {
    end_lap(end);
    goes_on_ = false;
  }

  /// Ends the lap, whose last sample is beyond the line, and begins the next one with the rest of that step.
  void cross_line() {
    RacingSample beyond = lap_.samples.back();
    RacingSample line = *at_distance(lap_.samples, length_);
    lap_.samples.back() = line;
    end_lap(RacingEnd::completed);
    goes_on_ = flying_;
    beyond.distance -= line.distance;
    beyond.time -= line.time;
    line.distance += begin_.distance;
    line.time += begin_.time;
    begin_lap(line);
    lap_.samples.push_back(beyond);
  }

  double length_, timeout_;  ///< m, s; of a lap
  std::uint64_t seed_;
  bool flying_;
  Motion before_;
  RacingSample begin_;  ///< start of the lap, distance and time since the standing start
  RacingLap lap_;       ///< lap that is being driven
  std::optional<RacingLap> ended_;
  bool goes_on_ = true;
};

}  // namespace

std::string_view name(RacingEnd end) noexcept {
  return end == RacingEnd::completed ? "completed" : end == RacingEnd::collision ? "collision" : "timeout";
}

std::optional<RacingSample> at_distance(std::span<const RacingSample> samples, double distance) {
  const auto after = std::find_if(samples.begin(), samples.end(),
                                  [&](const RacingSample& s) { return s.distance >= distance; });
  if (after == samples.end()) return std::nullopt;
  if (after == samples.begin()) return *after;
  const RacingSample& before = *std::prev(after);
  const double share = (distance - before.distance) / (after->distance - before.distance);
  RacingSample at = *after;
  at.distance = distance;
  at.time = before.time + share * (after->time - before.time);
  at.speed = before.speed + share * (after->speed - before.speed);
  return at;
}

double time_behind(std::span<const RacingSample> lap, std::span<const RacingSample> other, double distance) {
  const auto time = [&](std::span<const RacingSample> samples) {
    return at_distance(samples, distance).value_or(samples.back()).time;
  };
  return time(lap) - time(other);
}

std::array<double, racing_sectors> sector_times(std::span<const RacingSample> samples, double length) {
  std::array<double, racing_sectors> times;
  times.fill(std::numeric_limits<double>::quiet_NaN());
  double begin = 0;
  for (int i = 0; i < racing_sectors; ++i) {
    // The last sector ends with the lap, whatever the rounding of its length.
    const auto end = i + 1 < racing_sectors ? at_distance(samples, length * (i + 1) / racing_sectors)
                     : samples.back().distance >= length * (1 - 1e-9) ? std::optional(samples.back())
                                                                      : std::nullopt;
    if (!end) break;
    times[static_cast<std::size_t>(i)] = end->time - begin;
    begin = end->time;
  }
  return times;
}

GripUse grip_use(std::span<const RacingSample> samples, double limit) {
  std::vector<std::pair<double, double>> weighted;  // acceleration and duration
  double total = 0, beyond = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double duration = samples[i].time - samples[i - 1].time;
    if (!(duration > 0)) continue;  // the first sample of the next lap
    const double acceleration = std::hypot(samples[i].longitudinal, samples[i].lateral);
    weighted.emplace_back(acceleration, duration);
    total += duration;
    if (acceleration > limit * (1 + rounding)) beyond += duration;
  }
  if (weighted.empty()) return {};
  std::sort(weighted.begin(), weighted.end());
  return {weighted_percentile(weighted, total, 0.5), weighted_percentile(weighted, total, 0.99),
          beyond / total};
}

std::vector<RacingLap> drive_race(const LapSetup& setup, const RaceOptions& options,
                                  const RaceCallbacks& callbacks, const std::atomic<bool>* cancel) {
  if (options.laps < 1)
    throw std::invalid_argument("laps: " + std::to_string(options.laps) + " must be at least 1");
  if (setup.settings.rounds != 1)
    throw std::invalid_argument("world.rounds: " + std::to_string(setup.settings.rounds) +
                                " must be 1 in a race");
  const bool flying = !options.standing && setup.environment->course.closed;
  std::vector<RacingLap> laps;
  const auto driven = [&] { return static_cast<int>(laps.size()); };
  while (driven() < options.laps) {
    const std::uint64_t seed = lap_seed(options.seed, driven(), setup.settings.obstacles);
    LapDrive drive(setup, seed);
    LapClock clock(drive, seed, flying);
    while (driven() < options.laps && clock.goes_on()) {
      if (cancel && cancel->load(std::memory_order_relaxed)) return laps;
      drive.step([&](const ControlStep& step) {
        if (callbacks.on_step) callbacks.on_step(driven(), clock.of_lap(step));
      });
      clock.moved(drive);
      std::optional<RacingLap> lap = clock.take_ended();
      if (!lap) continue;
      laps.push_back(std::move(*lap));
      if (callbacks.on_lap) callbacks.on_lap(laps.back());
    }
  }
  return laps;
}

}  // namespace slalom::evaluation
