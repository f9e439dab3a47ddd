#pragma once

#include <cstdint>

#include "slalom/core/options.hpp"

namespace slalom::vehicle {

/// How probable a range is at a pose (Thrun, Burgard & Fox, "Probabilistic Robotics", MIT Press 2005, Ch. 6).
enum class SensorModel {
  likelihood_field,  ///< by the distance from the beam's end to the nearest wall (Table 6.3)
  beam,              ///< by the range that the map lets expect, from a table made at construction (Table 6.1)
};
inline const char* const* enum_names(SensorModel) {
  static constexpr const char* names[] = {"likelihood_field", "beam", nullptr};
  return names;
}

/// Options of Localiser.
struct LocaliserOptions {
  std::uint64_t seed = 0;  ///< seed of the random numbers
  SensorModel sensor_model = SensorModel::beam;

  double laser_x = 0.275;  ///< m, of the laser from the rear axle
  double laser_y = 0;      ///< m
  double laser_yaw = 0;    ///< rad
  int scan_readings = 0;   ///< a scan has so many readings or is refused; 0: any number

  int beams = 60;               ///< of a scan that are used, evenly chosen; 8 .. 1024
  int least_beams = 12;         ///< readings that a scan must have to be used
  double range_cap = 12;        ///< m, longer readings are not used
  double hit_deviation = 0.08;  ///< sigma_hit, m, of range, map and deskewing together
  double hit_weight = 0.85;     ///< z_hit, share of readings that come from the map
  double short_weight = 0.1;    ///< z_short, share that come from something in front of it; beam model only
  double short_rate = 0.5;      ///< lambda_short, 1/m; beam model only
  double lost_weight = 0.05;    ///< z_max, share that do not come back; beam model only
  double random_weight = 0.1;   ///< z_rand, share that come from anywhere
  double beam_exponent = 0.2;   ///< of each beam's probability: neighbouring beams err together
  double table_cell = 0.1;      ///< m, of the table of ranges; beam model only
  int table_angles = 180;       ///< of the table of ranges; beam model only

  double along_noise = 0.15;          ///< m per m driven, standard deviation along the car
  double across_noise = 0.05;         ///< m per m driven, sideways
  double turn_noise = 0.1;            ///< rad per rad turned
  double drift_noise = 0.04;          ///< rad per m driven
  double position_noise = 0.006;      ///< m per update, however little was driven
  double yaw_noise = 0.004;           ///< rad per update, however little was driven
  double max_speed = 12;              ///< m/s, odometry that moves faster has jumped
  double max_yaw_rate = 12;           ///< rad/s, odometry that turns faster has jumped
  double start_deviation = 0.3;       ///< m, of the particles about a given start
  double start_yaw_deviation = 0.15;  ///< rad, of the particles about a given start

  int least_particles = 500;      ///< 64 .. 1000000
  int most_particles = 4000;      ///< least_particles .. 1000000
  double kld_error = 0.05;        ///< epsilon, bound on the Kullback-Leibler divergence
  double kld_quantile = 2.326;    ///< z_(1 - delta) of the standard normal; 2.326: kept in 99 % of updates
  double bin_size = 0.25;         ///< m, of the bins that are counted
  double bin_angle = 0.1745;      ///< rad, of the bins that are counted
  double resample_below = 0.5;    ///< effective sample size over particles, below which is resampled
  double slow_rate = 0.01;        ///< alpha_slow, of the long-term average of the fit of the particles
  double fast_rate = 0.3;         ///< alpha_fast, of the short-term one
  double recovery_margin = 1.25;  ///< nu: other places are searched where nu * fast < slow
  double least_fit = 0.6;         ///< the long-term average counts as at least this
  double search_time = 2.0;       ///< s, for which the search goes on after the last cause
  double search_memory = 0.25;    ///< s, time constant over which places are compared by their fit
  double rival_margin = 0.05;     ///< in log fit, by which another place must be better to be taken
  int most_hypotheses = 96;       ///< places followed at once, 16 .. 4096
  int search_factor = 28;         ///< random poses weighed in an update of the search, per hypothesis
  double good_share = 0.6;        ///< of the weight near the estimate, from which on it counts as one place
  double good_fit = 0.6;          ///< share of explained beams, from which on the estimate counts as right

  /// Throws std::invalid_argument naming the field, its value and the rule.
  void validate() const;
};

namespace detail {

template <class Options, class Visit>
void visit_localiser_scan(Options& o, Visit&& visit) {
  visit(o.sensor_model, Declaration{.name = "sensor_model", .help = "how probable a range is at a pose"});
  visit(o.laser_x, Declaration{"laser_x", "", "m", "of the laser from the rear axle", -10, 10});
  visit(o.laser_y, Declaration{"laser_y", "", "m", "of the laser from the rear axle", -10, 10});
  visit(o.laser_yaw, Declaration{"laser_yaw", "", "rad", "of the laser", -3.2, 3.2});
  visit(o.scan_readings,
        Declaration{"scan_readings", "", "", "a scan has so many or is refused; 0: any", 0, 1e6});
  visit(o.beams, Declaration{"beams", "", "", "of a scan that are used", 8, 1024});
  visit(o.least_beams,
        Declaration{"least_beams", "", "", "readings that a scan must have to be used", 1, 1024});
  visit(o.range_cap, Declaration{"range_cap", "", "m", "longer readings are not used", 0.5, 1000});
  visit(o.hit_deviation, Declaration{"hit_deviation", "", "m", "of range and map together", 1e-3, 10});
  visit(o.hit_weight, Declaration{"hit_weight", "", "", "share of readings from the map", 1e-3, 1});
  visit(o.short_weight,
        Declaration{"short_weight", "", "", "share of readings from something before the map", 0, 1});
  visit(o.short_rate,
        Declaration{"short_rate", "", "1/m", "how soon something comes before the map", 0, 100});
  visit(o.lost_weight, Declaration{"lost_weight", "", "", "share of readings that do not come back", 0, 1});
  visit(o.random_weight, Declaration{"random_weight", "", "", "share of readings from anywhere", 1e-6, 1});
  visit(o.beam_exponent, Declaration{"beam_exponent", "", "", "of each beam's probability", 1e-3, 1});
  visit(o.table_cell, Declaration{"table_cell", "", "m", "of the table of ranges, beam model", 0.01, 1});
  visit(o.table_angles, Declaration{"table_angles", "", "", "of the table of ranges, beam model", 36, 1440});
}

template <class Options, class Visit>
void visit_localiser_filter(Options& o, Visit&& visit) {
  visit(o.along_noise, Declaration{"along_noise", "", "", "m per m driven, along the car", 0, 10});
  visit(o.across_noise, Declaration{"across_noise", "", "", "m per m driven, sideways", 0, 10});
  visit(o.turn_noise, Declaration{"turn_noise", "", "", "rad per rad turned", 0, 10});
  visit(o.drift_noise, Declaration{"drift_noise", "", "rad/m", "of the yaw per m driven", 0, 10});
  visit(o.position_noise, Declaration{"position_noise", "", "m", "per update", 1e-6, 1});
  visit(o.yaw_noise, Declaration{"yaw_noise", "", "rad", "per update", 1e-6, 1});
  visit(o.max_speed, Declaration{"max_speed", "", "m/s", "odometry that moves faster has jumped", 0.1, 100});
  visit(o.max_yaw_rate,
        Declaration{"max_yaw_rate", "", "rad/s", "odometry that turns faster has jumped", 0.1, 1000});
  visit(o.start_deviation,
        Declaration{"start_deviation", "", "m", "of particles about a given start", 0, 100});
  visit(o.start_yaw_deviation,
        Declaration{"start_yaw_deviation", "", "rad", "of particles about a given start", 0, 7});
  visit(o.least_particles, Declaration{"least_particles", "", "", "", 64, 1e6});
  visit(o.most_particles, Declaration{"most_particles", "", "", "at least least_particles", 64, 1e6});
  visit(o.kld_error, Declaration{"kld_error", "", "", "bound on the Kullback-Leibler divergence", 1e-3, 1});
  visit(o.kld_quantile, Declaration{"kld_quantile", "", "", "of the standard normal", 0, 6});
  visit(o.bin_size, Declaration{"bin_size", "", "m", "of the bins that are counted", 0.01, 10});
  visit(o.bin_angle, Declaration{"bin_angle", "", "rad", "of the bins that are counted", 0.01, 3.2});
  visit(o.resample_below,
        Declaration{"resample_below", "", "", "effective sample size over particles", 0, 1});
  visit(o.slow_rate, Declaration{"slow_rate", "", "", "of the long-term average of the fit", 1e-6, 1});
  visit(o.fast_rate, Declaration{"fast_rate", "", "", "of the short-term average of the fit", 1e-6, 1});
  visit(o.recovery_margin,
        Declaration{"recovery_margin", "", "", "search where margin * fast < slow", 1, 100});
  visit(o.least_fit, Declaration{"least_fit", "", "", "the long-term average counts as at least this", 0, 1});
  visit(o.search_time, Declaration{"search_time", "", "s", "of searching after the last cause", 0, 1000});
  visit(o.search_memory, Declaration{"search_memory", "", "s", "over which places are compared", 1e-3, 1000});
  visit(o.rival_margin, Declaration{"rival_margin", "", "", "in log fit, to be taken instead", 0, 10});
  visit(o.most_hypotheses, Declaration{"most_hypotheses", "", "", "places followed at once", 16, 4096});
  visit(o.search_factor,
        Declaration{"search_factor", "", "", "random poses per hypothesis and update", 1, 1000});
  visit(o.good_share, Declaration{"good_share", "", "", "of the weight near the estimate", 0, 1});
  visit(o.good_fit, Declaration{"good_fit", "", "", "share of explained beams", 0, 1});
}

}  // namespace detail

template <class Options, class Visit>
requires is_options_of<Options, LocaliserOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.seed, Declaration{.name = "seed", .help = "of all random numbers"});
  detail::visit_localiser_scan(o, visit);
  detail::visit_localiser_filter(o, visit);
}

}  // namespace slalom::vehicle
