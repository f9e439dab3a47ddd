#pragma once

#include "slalom/core/problem.hpp"
#include "slalom/core/problem_parts.hpp"

/// The arguments of the kernels of a solve.
namespace slalom::gpu {

constexpr int most_inputs = 16;
constexpr int block_threads = 256;  ///< threads of a block of any kernel

/// Number of values that a rollout starts from: the state, and the previous input where rates are limited.
template <class P>
constexpr int start_size = detail::state_size<P> + (detail::limits_rates<P> ? P::inputs : 0);

/// Whether a thread can draw the sample that it rolls out: eight normal values are whole steps.
template <int inputs>
constexpr bool can_fuse = 8 % inputs == 0;

/// The options of a solve, and how its samples are spread over blocks.
struct Settings {
  /// `tile` samples, a power of two, are rolled out at a time; a block takes a group of tiles.
  int horizon, samples, tile, tiles, groups;
  int fused;                          ///< whether a thread draws the sample that it rolls out
  float temperature, control_factor;  ///< control_factor = temperature (1 - discount)
  float low[most_inputs], high[most_inputs];
  float variance[most_inputs];
  // svg_mppi alone
  int guides, iterations, gradient_samples, restart;
  float gradient_temperature;
  float gradient_variance[most_inputs];
  double guide_step[most_inputs], restart_variance[most_inputs], variance_min[most_inputs],
      variance_max[most_inputs], guide_variance[most_inputs];
};

/// Sums over the samples of a group; weights are relative to `least_total`.
struct alignas(16) GroupSums {
  float least_total, least_cost, weight, squared;
  float cost, finite, collided, unused;
};

/// Results of a solve besides the plan.
struct Report {
  float least_cost, mean_cost, effective_samples, finite, collided;
  unsigned done;  ///< number of the solve, written last
};

/// Memory on the device.
struct Buffers {
  float* mean;       ///< [row], the last solution
  float* nominal;    ///< [row], svg_mppi alone
  float* variance;   ///< [row], svg_mppi alone
  double* theta;     ///< guides of svg_mppi, see GuideMemory
  float* partial;    ///< [group][row, padded]
  GroupSums* sums;   ///< [group]
  unsigned* ticket;  ///< how many blocks have ended, of the samples and of the guides; 0 between solves
  float* costs;      ///< [sample], or null
  float* plan;       ///< [row], in memory of the host
  Report* report;    ///< in memory of the host
};

/// Steps by which a sequence moves forward.
struct Shift {
  int whole;
  double part;  ///< [0, 1)
  static Shift of(double steps, int horizon) {
    const double within = steps > 0 ? (steps < horizon ? steps : horizon) : 0;
    return {int(within), within - int(within)};
  }
};

/// The argument of every kernel.
template <class P>
struct Arguments {
  alignas(P) unsigned char problem[sizeof(P)];
  float start[start_size<P>];
  Settings settings;
  Buffers buffers;
  unsigned long long seed, stream;  ///< random numbers of the samples
  Shift shift;                      ///< since the last solve
  unsigned solve;                   ///< its number, from 1
};

template <class P>
const P& problem_of(const Arguments<P>& a) {
  return *reinterpret_cast<const P*>(a.problem);
}

}  // namespace slalom::gpu
