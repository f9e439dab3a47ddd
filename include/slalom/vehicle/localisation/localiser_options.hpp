#pragma once

#include <cstdint>

#include "slalom/core/options.hpp"

namespace slalom::vehicle {

/// How probable a range is at a pose (Thrun, Burgard & Fox, "Probabilistic Robotics", MIT Press 2005, Ch. 6).
enum class SensorModel {
  likelihood_field,  ///< by the distance from the beam's end to the nearest wall (Table 6.3)
  beam,  ///< by the range expected from the map, from a table that is computed at construction (Table 6.1)
};
/// The names of the enumerators, in order.
inline const char* const* enum_names(SensorModel) {
  static constexpr const char* names[] = {"likelihood_field", "beam", nullptr};
  return names;
}

/// How the readings of a scan are distributed about what the map predicts.
struct LocaliserBeamOptions {
  double hit_deviation = 0.08;  ///< sigma_hit, m, of range, map and deskewing together
  double hit_weight = 0.85;     ///< z_hit, share of readings that come from the map
  /// z_short, share that come from something in front of the map; beam model only
  double short_weight = 0.1;
  double short_rate = 0.5;     ///< lambda_short, 1/m; beam model only
  double lost_weight = 0.05;   ///< z_max, share without a return; beam model only
  double random_weight = 0.1;  ///< z_rand, share of random readings
  /// of each beam's probability, since the errors of neighbouring beams are correlated
  double beam_exponent = 0.2;
};

/// Errors of the odometry, and when it is taken for a jump.
struct LocaliserMotionOptions {
  double along_noise = 0.15;      ///< m per m driven, standard deviation along the car
  double across_noise = 0.05;     ///< m per m driven, across the car
  double turn_noise = 0.1;        ///< rad per rad turned
  double drift_noise = 0.04;      ///< rad per m driven
  double position_noise = 0.006;  ///< m per update, in addition
  double yaw_noise = 0.004;       ///< rad per update, in addition
  double max_speed = 12;          ///< m/s, faster odometry is a jump
  double max_yaw_rate = 12;       ///< rad/s, faster odometry is a jump
};

/// Number of particles (KLD sampling) and resampling.
struct LocaliserParticleOptions {
  int min_particles = 500;      ///< 64 .. 1000000
  int max_particles = 4000;     ///< min_particles .. 1000000
  double kld_error = 0.05;      ///< epsilon, bound on the Kullback-Leibler divergence
  double kld_quantile = 2.326;  ///< z_(1 - delta) of the standard normal; 2.326: kept in 99 % of updates
  double bin_size = 0.25;       ///< m, size of the bins whose number determines that of the particles
  double bin_angle = 0.1745;    ///< rad, size of these bins
  double resample_below = 0.5;  ///< resamples where effective sample size / particles is below
};

/// Detection of a lost position and the search for it.
struct LocaliserRecoveryOptions {
  double slow_rate = 0.01;        ///< alpha_slow, of the long-term average of the fit of the particles
  double fast_rate = 0.3;         ///< alpha_fast, of the short-term average
  double recovery_margin = 1.25;  ///< nu: a search starts where nu * fast < slow
  double min_fit = 0.6;           ///< lower bound of the long-term average
  double search_time = 2.0;       ///< s, of the search after its last cause
  double search_memory = 0.25;    ///< s, time constant of the average fit by which places are compared
  double rival_margin = 0.05;     ///< in log fit, by which another place must be better
  int max_hypotheses = 96;        ///< number of hypotheses, 16 .. 4096
  int search_factor = 28;         ///< random poses per hypothesis in each update of the search
};

/// Options of Localiser. The names of options do not contain those of the groups.
struct LocaliserOptions {
  std::uint64_t seed = 0;                        ///< seed of the random numbers
  SensorModel sensor_model = SensorModel::beam;  ///< probability of a range at a pose

  double laser_x = 0.275;  ///< m, of the laser from the rear axle
  double laser_y = 0;      ///< m
  double laser_yaw = 0;    ///< rad
  int scan_readings = 0;   ///< number of readings of a valid scan; 0: any

  int beams = 60;               ///< number used per scan, evenly spaced; 8 .. 1024
  int min_beams = 12;           ///< a scan with fewer usable readings is not used
  double range_cap = 12;        ///< m, longer readings are not used
  LocaliserBeamOptions beam{};  ///< probabilities of ranges
  double table_cell = 0.1;      ///< m, cell of the table of ranges; beam model only
  int table_angles = 180;       ///< number of angles of the table of ranges; beam model only

  LocaliserMotionOptions motion{};    ///< odometry
  double start_deviation = 0.3;       ///< m, of the particles around a given start
  double start_yaw_deviation = 0.15;  ///< rad, of the particles around a given start

  LocaliserParticleOptions particles{};  ///< number of particles and resampling
  LocaliserRecoveryOptions recovery{};   ///< loss of the position and search
  double good_share = 0.6;               ///< share of the weight near the estimate of a reliable one
  double good_fit = 0.6;                 ///< share of explained beams of a reliable estimate

  /// Throws std::invalid_argument naming the field, its value and the rule.
  void validate() const;
};

namespace detail {

template <class Options, class Visit>
void visit_localiser_scan(Options& o, Visit&& visit) {
  visit(o.sensor_model, Declaration{.name = "sensor_model", .help = "probability of a range at a pose"});
  visit(o.laser_x, Declaration{"laser_x", "", "m", "laser, ahead of the rear axle", -10, 10});
  visit(o.laser_y, Declaration{"laser_y", "", "m", "laser, to the left of the rear axle", -10, 10});
  visit(o.laser_yaw, Declaration{"laser_yaw", "", "rad", "direction of the laser", -3.2, 3.2});
  visit(o.scan_readings,
        Declaration{"scan_readings", "", "", "number of readings of a valid scan; 0: any", 0, 1e6});
  visit(o.beams, Declaration{"beams", "", "", "number of beams used per scan", 8, 1024});
  visit(o.min_beams,
        Declaration{"min_beams", "", "", "a scan with fewer usable readings is not used", 1, 1024});
  visit(o.range_cap, Declaration{"range_cap", "", "m", "longer readings are not used", 0.5, 1000});
  visit(o.beam.hit_deviation,
        Declaration{"hit_deviation", "", "m", "standard deviation of range and map together", 1e-3, 10});
  visit(o.beam.hit_weight, Declaration{"hit_weight", "", "", "share of readings from the map", 1e-3, 1});
  visit(o.beam.short_weight,
        Declaration{"short_weight", "", "", "share of readings from something in front of the map", 0, 1});
  visit(o.beam.short_rate,
        Declaration{"short_rate", "", "1/m", "rate of readings from something in front of the map", 0, 100});
  visit(o.beam.lost_weight, Declaration{"lost_weight", "", "", "share of readings without a return", 0, 1});
  visit(o.beam.random_weight, Declaration{"random_weight", "", "", "share of random readings", 1e-6, 1});
  visit(o.beam.beam_exponent,
        Declaration{"beam_exponent", "", "", "exponent of each beam's probability", 1e-3, 1});
  visit(o.table_cell, Declaration{"table_cell", "", "m", "cell of the table of ranges, beam model", 0.01, 1});
  visit(o.table_angles,
        Declaration{"table_angles", "", "", "angles of the table of ranges, beam model", 36, 1440});
}

template <class Options, class Visit>
void visit_localiser_filter(Options& o, Visit&& visit) {
  visit(o.motion.along_noise, Declaration{"along_noise", "", "", "m per m driven, along the car", 0, 10});
  visit(o.motion.across_noise, Declaration{"across_noise", "", "", "m per m driven, across the car", 0, 10});
  visit(o.motion.turn_noise, Declaration{"turn_noise", "", "", "rad per rad turned", 0, 10});
  visit(o.motion.drift_noise, Declaration{"drift_noise", "", "rad/m", "of the yaw, per m driven", 0, 10});
  visit(o.motion.position_noise,
        Declaration{"position_noise", "", "m", "of the position, per update", 1e-6, 1});
  visit(o.motion.yaw_noise, Declaration{"yaw_noise", "", "rad", "of the yaw, per update", 1e-6, 1});
  visit(o.motion.max_speed, Declaration{"max_speed", "", "m/s", "faster odometry is a jump", 0.1, 100});
  visit(o.motion.max_yaw_rate,
        Declaration{"max_yaw_rate", "", "rad/s", "faster odometry is a jump", 0.1, 1000});
  visit(o.start_deviation,
        Declaration{"start_deviation", "", "m", "of the particles around a given start", 0, 100});
  visit(o.start_yaw_deviation,
        Declaration{"start_yaw_deviation", "", "rad", "of the particles around a given start", 0, 7});
  visit(o.particles.min_particles,
        Declaration{"min_particles", "", "", "smallest number of particles", 64, 1e6});
  visit(o.particles.max_particles,
        Declaration{"max_particles", "", "", "largest number of particles, at least min_particles", 64, 1e6});
  visit(o.particles.kld_error,
        Declaration{"kld_error", "", "", "bound on the Kullback-Leibler divergence", 1e-3, 1});
  visit(o.particles.kld_quantile,
        Declaration{"kld_quantile", "", "", "quantile of the standard normal for the bound", 0, 6});
  visit(o.particles.bin_size,
        Declaration{"bin_size", "", "m", "size of the bins that are counted", 0.01, 10});
  visit(o.particles.bin_angle,
        Declaration{"bin_angle", "", "rad", "size of the bins that are counted", 0.01, 3.2});
  visit(o.particles.resample_below,
        Declaration{"resample_below", "", "", "resample where effective sample size / particles is below", 0,
                    1});
  visit(o.recovery.slow_rate,
        Declaration{"slow_rate", "", "", "rate of the long-term average of the fit", 1e-6, 1});
  visit(o.recovery.fast_rate,
        Declaration{"fast_rate", "", "", "rate of the short-term average of the fit", 1e-6, 1});
  visit(o.recovery.recovery_margin,
        Declaration{"recovery_margin", "", "", "search where margin * fast < slow", 1, 100});
  visit(o.recovery.min_fit, Declaration{"min_fit", "", "", "lower bound of the long-term average", 0, 1});
  visit(o.recovery.search_time,
        Declaration{"search_time", "", "s", "duration of a search after its last cause", 0, 1000});
  visit(o.recovery.search_memory,
        Declaration{"search_memory", "", "s", "time constant of the fit by which places are compared", 1e-3,
                    1000});
  visit(o.recovery.rival_margin,
        Declaration{"rival_margin", "", "", "in log fit, by which another place must be better", 0, 10});
  visit(o.recovery.max_hypotheses, Declaration{"max_hypotheses", "", "", "number of hypotheses", 16, 4096});
  visit(o.recovery.search_factor,
        Declaration{"search_factor", "", "", "random poses per hypothesis and update", 1, 1000});
  visit(o.good_share,
        Declaration{"good_share", "", "", "share of the weight near a reliable estimate", 0, 1});
  visit(o.good_fit, Declaration{"good_fit", "", "", "share of explained beams of a reliable estimate", 0, 1});
}

}  // namespace detail

/// Declares every option by name, unit, help and range.
template <class Options, class Visit>
requires is_options_of<Options, LocaliserOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.seed, Declaration{.name = "seed", .help = "seed of the random numbers"});
  detail::visit_localiser_scan(o, visit);
  detail::visit_localiser_filter(o, visit);
}

}  // namespace slalom::vehicle
