#include "slalom/vehicle/localisation/localiser.hpp"

#include <chrono>

#include "localiser_particles.hpp"
#include "localiser_search.hpp"
#include "localiser_sensor.hpp"
#include "slalom/maps/pose_limits.hpp"

namespace slalom::vehicle {
namespace {

using detail::Displacement;
using detail::FreeCells;
using detail::Particles;
using detail::ScanBeams;
using detail::SensorTables;

/// A stamp that is this much (s) before the last one means that the clock was set back.
constexpr double clock_set_back = 1.0;
/// Tolerance of the limits for a motion of the odometry: m, rad.
constexpr double jump_slack = 0.1;
/// After a jump of the odometry the last motion is continued for at most this time, s.
constexpr double max_prediction = 0.2;

constexpr double max_yaw_rate = 12;  // rad/s, faster odometry is a jump
/// Exponent of each beam's probability: errors of neighbouring beams are correlated.
constexpr double beam_exponent = 0.2;
constexpr double start_deviation = 0.3, start_yaw_deviation = 0.15;  // m, rad, around a given start
constexpr double resample_below = 0.5;                               // effective sample size / particles
constexpr double slow_rate = 0.01, fast_rate = 0.3;  // alpha_slow and alpha_fast, of averages of the fit
constexpr double recovery_margin = 1.25;             // nu: a search starts where nu * fast < slow
constexpr double min_fit = 0.6;                      // lower bound of the long-term average
constexpr double search_time = 2;                    // s, of a search after its last cause
constexpr double search_memory = 0.25;  // s, time constant of the fit by which places are compared
constexpr double rival_margin = 0.05;   // difference in log fit by which another place must be better
constexpr double good_share = 0.6,
                 good_fit = 0.6;  // least share of the weight and fit of a reliable estimate

/// A hypothesis within this distance (m, rad) is the same place.
constexpr double near_place = 0.5, near_yaw = 0.3;
/// The longer a place has fitted well, the larger the margin by which another one must fit better, since the
/// two directions of a corridor look alike: the margin grows by `rival_margin` per `trust_unit` (s), and each
/// doubtful update reduces it by a factor.
constexpr double trust_unit = 0.3, max_trust = 5, doubt_keeps = 0.93, min_trust = 0.3;
constexpr double relocated_deviation = 0.15, relocated_yaw_deviation = 0.08;

/// The pose `to` in the frame of `from`.
maps::Pose relative(const maps::Pose& from, const maps::Pose& to) {
  const maps::Point p = maps::inverse_transform(from, {to.x, to.y});
  return {p.x, p.y, maps::wrap_angle(to.yaw - from.yaw)};
}

maps::Pose compose(const maps::Pose& frame, const maps::Pose& pose) {
  const maps::Point p = maps::transform(frame, {pose.x, pose.y});
  return {p.x, p.y, maps::wrap_angle(frame.yaw + pose.yaw)};
}

}  // namespace

struct Localiser::Implementation {
  Implementation(const maps::OccupancyGrid& map, const LocaliserOptions& o)
      : options(o),
        origin(map.origin),
        sensor(std::make_shared<SensorTables>(map, options)),
        free_cells(std::make_shared<FreeCells>(map)),
        particles(options, free_cells),
        search(free_cells),
        beams(options.beams) {
    options.sensor_model = sensor->model();
    start_everywhere();
  }

  RandomKey next_key() noexcept { return {options.seed, ++stream}; }

  void start_everywhere() noexcept {
    particles.spread_everywhere(next_key());
    forget();
    lost = true;
  }
  void start_at(const maps::Pose& pose) noexcept {
    particles.spread_about(relative(origin, pose), start_deviation, start_yaw_deviation, next_key());
    forget();
    output.pose = pose;
    trust = max_trust;
    settled = true;
  }
  void forget() noexcept {
    output = {};
    output.particles = particles.count();
    has_odometry = false;
    slow = fast = 0;
    search_until = -1;
    trust = in_vain = 0;
    settled = lost = false;
    search.clear();
  }

  LocaliserStatus move(const LocaliserInput& input) noexcept;
  void use_scan() noexcept;
  void estimate() noexcept;
  void look_elsewhere() noexcept;
  /// Whether a search has found no better place, and the poor fit is due to something in front of the walls.
  bool stands() const noexcept { return in_vain >= search_time && explained.counted >= good_fit; }

  LocaliserOptions options;
  maps::Pose origin;  ///< origin of the grid, map frame
  std::shared_ptr<const SensorTables> sensor;
  std::shared_ptr<const FreeCells> free_cells;
  Particles particles;
  detail::Search search;
  ScanBeams beams;
  LocaliserOutput output;
  std::uint64_t stream = 0;

  bool has_odometry = false;
  maps::Pose odometry;
  double stamp = 0;
  maps::Pose velocity;                ///< m/s and rad/s in the car's frame, of the last good motion
  maps::Pose step;                    ///< m and rad in the car's frame, since the last update
  double elapsed = 0;                 ///< s, since the last update
  SensorTables::Explained explained;  ///< quality of the estimate
  double slow = 0, fast = 0;          ///< its fit, averaged
  double in_vain = 0, trust = 0;      ///< s, of the present search in vain; s without doubt, reduced by it
  bool settled = false;               ///< the place was given, or a search ended with it
  bool lost = false;                  ///< no place is known, and no scan was used since
  double search_until = -1;           ///< s, stamp
  double place_log_fit = 0;           ///< log fit of the particles' place, averaged as for a hypothesis
};

/// Moves the particles by what the odometry says since the last update.
LocaliserStatus Localiser::Implementation::move(const LocaliserInput& input) noexcept {
  LocaliserStatus status = LocaliserStatus::ok;
  Displacement moved;
  if (has_odometry) {
    elapsed = input.stamp - stamp;
    moved.step = relative(odometry, input.odometry);
    const double distance = std::hypot(moved.step.x, moved.step.y);
    const bool jumped = elapsed <= 0 || distance > options.max_speed * elapsed + jump_slack ||
                        std::abs(moved.step.yaw) > max_yaw_rate * elapsed + jump_slack;
    if (jumped) {
      const double guess = std::clamp(elapsed, 0.0, max_prediction);
      moved.step = {velocity.x * guess, velocity.y * guess, velocity.yaw * guess};
      status = LocaliserStatus::odometry_jump;
    } else {
      velocity = {moved.step.x / elapsed, moved.step.y / elapsed, moved.step.yaw / elapsed};
    }
  } else {
    velocity = {};
    elapsed = 0;
  }
  const double distance = std::hypot(moved.step.x, moved.step.y);
  const double doubt = status == LocaliserStatus::ok ? 1 : 3;
  moved.along = doubt * (options.along_noise * distance + options.position_noise);
  moved.across = doubt * (options.across_noise * distance + options.position_noise);
  moved.turn = doubt * (options.turn_noise * std::abs(moved.step.yaw) + options.drift_noise * distance +
                        options.yaw_noise);
  step = moved.step;
  particles.move(moved, next_key());
  output.pose = compose(output.pose, moved.step);
  has_odometry = true;
  odometry = input.odometry;
  stamp = input.stamp;
  return status;
}

void Localiser::Implementation::estimate() noexcept {
  const Particles::Estimate found = particles.estimate();
  explained = sensor->explain(found.pose, beams);
  output.fit = explained.share;
  output.share = found.share;
  output.health = output.fit * output.share;
  output.pose = compose(origin, found.pose);
  // The covariance turned from the grid's frame into the map's: R C R^T on x and y.
  const double c = std::cos(origin.yaw), s = std::sin(origin.yaw);
  const double turn[3][3] = {{c, -s, 0}, {s, c, 0}, {0, 0, 1}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      double sum = 0;
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) sum += turn[i][k] * found.covariance[k][l] * turn[j][l];
      output.covariance[i][j] = sum;
    }
  }
}

/// Weights the particles by the scan, computes the estimate, and resamples if necessary (Table 8.3).
void Localiser::Implementation::use_scan() noexcept {
  output.particles = particles.count();
  output.effective_samples = particles.weigh(*sensor, beams, beam_exponent);
  estimate();
  slow = slow == 0 ? explained.fit : slow + slow_rate * (explained.fit - slow);
  fast = fast == 0 ? explained.fit : fast + fast_rate * (explained.fit - fast);
  if (output.effective_samples < resample_below * particles.count()) particles.resample(next_key());
  look_elsewhere();
}

/// Searches other places while there is cause to, and moves the particles to one that fits better.
void Localiser::Implementation::look_elsewhere() noexcept {
  const bool doubtful = recovery_margin * fast < std::max(slow, min_fit);
  const bool was_searching = output.searching;
  // A place that this search has found competes with the others on equal terms until the search is over.
  if (stands()) settled = true;
  if (doubtful && !stands()) {
    trust *= doubt_keeps;
  } else if (settled) {
    trust = std::min(trust + std::max(0.0, elapsed), max_trust);
  }
  // The particles that fit the first scan best may all be in a wrong place.
  const bool cause = doubtful || lost;
  lost = false;
  if (cause) search_until = stamp + search_time;
  output.searching = cause || (was_searching && stamp < search_until);
  if (!output.searching) {
    settled = true;
    in_vain = 0;
    return;
  }
  if (was_searching) in_vain += std::max(0.0, elapsed);
  if (!was_searching) search.clear();

  const maps::Pose place = relative(origin, output.pose);
  const double memory = std::exp(-std::max(0.0, elapsed) / search_memory);
  const double now = search.log_fit_at(place, *sensor, beams);
  place_log_fit = was_searching ? memory * place_log_fit + (1 - memory) * now : now;
  search.update(step, *sensor, beams, memory, next_key());
  const detail::Search::Hypothesis* best = search.best();
  const double margin = settled ? rival_margin * (1 + trust / trust_unit) : 0;
  if (!best || best->log_fit < place_log_fit + margin) return;
  const double apart = std::hypot(best->pose.x - place.x, best->pose.y - place.y);
  const double turned = std::abs(maps::wrap_angle(best->pose.yaw - place.yaw));
  if (output.share > good_share && apart < near_place && turned < near_yaw) return;
  if (!search.confirms(best->pose, place, *sensor, beams)) return;
  particles.spread_about(best->pose, relocated_deviation, relocated_yaw_deviation, next_key());
  place_log_fit = best->log_fit;
  trust = in_vain = 0;
  settled = false;
  estimate();
}

void LocaliserOptions::validate() const {
  validate_options(*this, "localiser");
  if (max_particles < min_particles)
    throw std::invalid_argument("localiser.max_particles: " + std::to_string(max_particles) +
                                " must be at least min_particles, " + std::to_string(min_particles));
  if (min_beams > beams)
    throw std::invalid_argument("localiser.min_beams: " + std::to_string(min_beams) +
                                " must be at most beams, " + std::to_string(beams));
}

Localiser::Localiser(const maps::OccupancyGrid& map, const LocaliserOptions& options) {
  options.validate();
  detail::check_map(map);
  implementation_ = std::make_unique<Implementation>(map, options);
}
Localiser::~Localiser() = default;
Localiser::Localiser(const Localiser& other)
    : implementation_(std::make_unique<Implementation>(*other.implementation_)) {}
Localiser& Localiser::operator=(const Localiser& other) {
  return *this = Localiser(other);
}
Localiser::Localiser(Localiser&&) noexcept = default;
Localiser& Localiser::operator=(Localiser&&) noexcept = default;

bool Localiser::start_at(const maps::Pose& pose) noexcept {
  if (!maps::is_plausible(pose)) return false;
  implementation_->start_at(pose);
  return true;
}
void Localiser::start_everywhere() noexcept {
  implementation_->start_everywhere();
}
void Localiser::reset(std::uint64_t seed) noexcept {
  implementation_->options.seed = seed;
  implementation_->stream = 0;
  implementation_->start_everywhere();
}

const LocaliserOutput& Localiser::update(const LocaliserInput& input) noexcept {
  const auto begin = std::chrono::steady_clock::now();
  Implementation& self = *implementation_;
  LocaliserOutput& out = self.output;
  const auto finish = [&](LocaliserStatus status) -> const LocaliserOutput& {
    out.status = status;
    out.update_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return out;
  };
  out.beams = 0;
  if (!maps::is_plausible(input.odometry) || !(std::abs(input.stamp) <= LocaliserInput::latest))
    return finish(LocaliserStatus::bad_odometry);
  if (self.has_odometry && input.stamp <= self.stamp && input.stamp > self.stamp - clock_set_back)
    return finish(LocaliserStatus::stale);
  const LocaliserStatus moved = self.move(input);
  if (!detail::choose_beams(input.scan, self.options, self.beams)) return finish(LocaliserStatus::bad_scan);
  out.beams = self.beams.hits;
  self.use_scan();
  if (moved != LocaliserStatus::ok) return finish(moved);
  const bool fits = out.fit >= good_fit || self.stands();
  const bool good = out.share >= good_share && fits && self.trust >= min_trust;
  return finish(good ? LocaliserStatus::ok : LocaliserStatus::uncertain);
}

const LocaliserOutput& Localiser::output() const noexcept {
  return implementation_->output;
}
maps::Pose Localiser::odometry_frame() const noexcept {
  const Implementation& self = *implementation_;
  if (!self.has_odometry) return self.output.pose;
  return compose(self.output.pose, relative(self.odometry, {}));
}
int Localiser::particle_count() const noexcept {
  return implementation_->particles.count();
}
Particle Localiser::particle(int index) const noexcept {
  const Implementation& self = *implementation_;
  return {compose(self.origin, self.particles.pose(index)), self.particles.weight(index)};
}
const LocaliserOptions& Localiser::options() const noexcept {
  return implementation_->options;
}

}  // namespace slalom::vehicle
