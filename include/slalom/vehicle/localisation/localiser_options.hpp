#pragma once

#include <cstdint>

#include "slalom/core/options.hpp"

namespace slalom::vehicle {

/// How probable a range is at a pose (Thrun, Burgard & Fox, "Probabilistic Robotics", MIT Press 2005, Ch. 6).
enum class SensorModel {
  likelihood_field,  ///< distance from the beam's end to the nearest wall (Table 6.3)
  beam,              ///< range expected from the map, by a table that is computed at construction (Table 6.1)
};
inline const char* const* enum_names(SensorModel) {
  static constexpr const char* names[] = {"likelihood_field", "beam", nullptr};
  return names;
}

/// The distribution of the readings of a scan about the prediction of the map.
/// `visit_localiser_scan` below describes the fields.
struct LocaliserBeamOptions {
  double hit_deviation = 0.08;
  double hit_weight = 0.85;
  double short_weight = 0.1;
  double short_rate = 0.5;
  double lost_weight = 0.05;
  double random_weight = 0.1;
  double beam_exponent = 0.2;
};

/// Errors of the odometry, and when it is taken for a jump.
/// `visit_localiser_filter` below describes the fields.
struct LocaliserMotionOptions {
  double along_noise = 0.15;
  double across_noise = 0.05;
  double turn_noise = 0.1;
  double drift_noise = 0.04;
  double position_noise = 0.006;
  double yaw_noise = 0.004;
  double max_speed = 12;
  double max_yaw_rate = 12;
};

/// Number of particles (KLD sampling) and resampling.
/// `visit_localiser_filter` below describes the fields.
struct LocaliserParticleOptions {
  int min_particles = 500;
  int max_particles = 4000;
  double kld_error = 0.05;
  double kld_quantile = 2.326;
  double bin_size = 0.25;
  double bin_angle = 0.1745;
  double resample_below = 0.5;
};

/// Detection of a lost position and the search for it.
/// `visit_localiser_filter` below describes the fields.
struct LocaliserRecoveryOptions {
  double slow_rate = 0.01;
  double fast_rate = 0.3;
  double recovery_margin = 1.25;
  double min_fit = 0.6;
  double search_time = 2.0;
  double search_memory = 0.25;
  double rival_margin = 0.05;
  int max_hypotheses = 96;
  int search_factor = 28;
};

/// Options of Localiser. The names of options do not contain those of the groups.
/// `visit_options` below describes the fields.
struct LocaliserOptions {
  std::uint64_t seed = 0;
  SensorModel sensor_model = SensorModel::beam;

  double laser_x = 0.275;
  double laser_y = 0;
  double laser_yaw = 0;
  int scan_readings = 0;

  int beams = 60;
  int min_beams = 12;
  double range_cap = 12;
  LocaliserBeamOptions beam{};  ///< probabilities of ranges
  double table_cell = 0.1;
  int table_angles = 180;

  LocaliserMotionOptions motion{};  ///< odometry
  double start_deviation = 0.3;
  double start_yaw_deviation = 0.15;

  LocaliserParticleOptions particles{};  ///< number of particles and resampling
  LocaliserRecoveryOptions recovery{};   ///< loss of the position and search
  double good_share = 0.6;
  double good_fit = 0.6;

  /// Throws std::invalid_argument naming the field, its value and the rule.
  void validate() const;
};

namespace detail {

template <class Options, class Visit>
void visit_localiser_scan(Options& o, Visit&& visit) {
  visit(o.sensor_model, {"sensor_model", "", "probability of a range at a pose"});
  visit(o.laser_x, {"laser_x", "m", "position of the laser ahead of the rear axle", -10, 10});
  visit(o.laser_y, {"laser_y", "m", "position of the laser to the left of the rear axle", -10, 10});
  visit(o.laser_yaw, {"laser_yaw", "rad", "direction of the laser", -3.2, 3.2});
  visit(o.scan_readings, {"scan_readings", "", "number of readings of a valid scan; 0: any", 0, 1e6});
  visit(o.beams, {"beams", "", "number of beams used per scan, evenly spaced", 8, 1024});
  visit(o.min_beams, {"min_beams", "", "a scan with fewer usable readings is not used", 1, 1024});
  visit(o.range_cap, {"range_cap", "m", "longer readings are not used", 0.5, 1000});
  visit(o.beam.hit_deviation,
        {"hit_deviation", "m", "standard deviation of range, map and deskewing together", 1e-3, 10,
         "sigma_hit"});
  visit(o.beam.hit_weight, {"hit_weight", "", "share of readings from the map", 1e-3, 1, "z_hit"});
  visit(o.beam.short_weight,
        {"short_weight", "", "share of readings from something in front of the map; beam model only", 0, 1,
         "z_short"});
  visit(o.beam.short_rate,
        {"short_rate", "1/m", "rate of readings from something in front of the map; beam model only", 0, 100,
         "lambda_short"});
  visit(o.beam.lost_weight,
        {"lost_weight", "", "share of readings without a return; beam model only", 0, 1, "z_max"});
  visit(o.beam.random_weight, {"random_weight", "", "share of random readings", 1e-6, 1, "z_rand"});
  visit(o.beam.beam_exponent,
        {"beam_exponent", "",
         "exponent of each beam's probability: errors of neighbouring beams are correlated", 1e-3, 1});
  visit(o.table_cell, {"table_cell", "m", "size of a cell of the table of ranges; beam model only", 0.01, 1});
  visit(o.table_angles, {"table_angles", "", "angles of the table of ranges; beam model only", 36, 1440});
}

template <class Options, class Visit>
void visit_localiser_filter(Options& o, Visit&& visit) {
  visit(o.motion.along_noise, {"along_noise", "", "standard deviation along the car, m per m driven", 0, 10});
  visit(o.motion.across_noise,
        {"across_noise", "", "standard deviation across the car, m per m driven", 0, 10});
  visit(o.motion.turn_noise, {"turn_noise", "", "standard deviation of the yaw, rad per rad turned", 0, 10});
  visit(o.motion.drift_noise, {"drift_noise", "rad/m", "standard deviation of the yaw per m driven", 0, 10});
  visit(o.motion.position_noise,
        {"position_noise", "m", "standard deviation of the position in each update, in addition", 1e-6, 1});
  visit(o.motion.yaw_noise,
        {"yaw_noise", "rad", "standard deviation of the yaw in each update, in addition", 1e-6, 1});
  visit(o.motion.max_speed, {"max_speed", "m/s", "faster odometry is a jump", 0.1, 100});
  visit(o.motion.max_yaw_rate, {"max_yaw_rate", "rad/s", "faster odometry is a jump", 0.1, 1000});
  visit(o.start_deviation, {"start_deviation", "m",
                            "standard deviation of the particles' positions around a given start", 0, 100});
  visit(o.start_yaw_deviation, {"start_yaw_deviation", "rad",
                                "standard deviation of the particles' yaws around a given start", 0, 7});
  visit(o.particles.min_particles, {"min_particles", "", "smallest number of particles", 64, 1e6});
  visit(o.particles.max_particles,
        {"max_particles", "", "largest number of particles, at least min_particles", 64, 1e6});
  visit(o.particles.kld_error,
        {"kld_error", "", "bound on the Kullback-Leibler divergence", 1e-3, 1, "epsilon"});
  visit(o.particles.kld_quantile,
        {"kld_quantile", "",
         "quantile of the standard normal for the bound; 2.326: kept in 99 % of the updates", 0, 6,
         "z_(1 - delta)"});
  visit(o.particles.bin_size,
        {"bin_size", "m", "size of the bins whose number determines that of the particles", 0.01, 10});
  visit(o.particles.bin_angle,
        {"bin_angle", "rad", "angle of the bins whose number determines that of the particles", 0.01, 3.2});
  visit(o.particles.resample_below,
        {"resample_below", "", "effective sample size / particles below which they are resampled", 0, 1});
  visit(o.recovery.slow_rate,
        {"slow_rate", "", "rate of the long-term average of the fit", 1e-6, 1, "alpha_slow"});
  visit(o.recovery.fast_rate,
        {"fast_rate", "", "rate of the short-term average of the fit", 1e-6, 1, "alpha_fast"});
  visit(o.recovery.recovery_margin,
        {"recovery_margin", "", "a search starts where nu * fast average < slow average", 1, 100, "nu"});
  visit(o.recovery.min_fit, {"min_fit", "", "lower bound of the long-term average", 0, 1});
  visit(o.recovery.search_time, {"search_time", "s", "duration of a search after its last cause", 0, 1000});
  visit(o.recovery.search_memory,
        {"search_memory", "s", "time constant of the fit by which places are compared", 1e-3, 1000});
  visit(o.recovery.rival_margin,
        {"rival_margin", "", "difference in log fit by which another place must be better", 0, 10});
  visit(o.recovery.max_hypotheses, {"max_hypotheses", "", "number of hypotheses", 16, 4096});
  visit(o.recovery.search_factor,
        {"search_factor", "", "random poses per hypothesis in each update of the search", 1, 1000});
  visit(o.good_share, {"good_share", "", "least share of the weight near a reliable estimate", 0, 1});
  visit(o.good_fit, {"good_fit", "", "least share of explained beams of a reliable estimate", 0, 1});
}

}  // namespace detail

template <class Options, class Visit>
requires is_options_of<Options, LocaliserOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.seed, {"seed", "", "seed of the random numbers"});
  detail::visit_localiser_scan(o, visit);
  detail::visit_localiser_filter(o, visit);
}

}  // namespace slalom::vehicle
