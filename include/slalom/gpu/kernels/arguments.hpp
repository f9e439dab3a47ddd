#pragma once

#include "slalom/core/problem.hpp"
#include "slalom/core/problem_parts.hpp"
#include "slalom/gpu/kernels/block.hpp"

/// The arguments of the kernels of a solve.
namespace slalom::gpu {

constexpr int most_inputs = 16;

/// The options of a solve, and how its samples are spread over blocks.
struct Settings {
  /// `tile` samples, a power of two, are rolled out at a time; a block takes a group of tiles.
  int horizon, samples, tile, tiles, groups;
  int fused;  ///< whether a thread draws the sample that it rolls out
  float temperature;
  float low[most_inputs], high[most_inputs], variance[most_inputs];
  // svg_mppi alone; `guides` is 0 in mppi
  int guides, iterations, gradient_samples, restart;
  float gradient_temperature, gradient_variance[most_inputs];
  double guide_step[most_inputs], guide_variance[most_inputs], restart_variance[most_inputs],
      variance_min[most_inputs], variance_max[most_inputs];
};

/// Sums over the samples of a group; weights are relative to the `least` cost.
struct alignas(16) GroupSums {
  float least, weight, squared, cost;
  float finite, collided, factor, unused;
};

/// Results of a solve besides the plan.
struct Report {
  float least_cost, mean_cost, effective_samples, finite, collided;
  unsigned done;  ///< number of the solve, written last
};

/// Memory on the device; plan and report are in memory of the host.
struct Buffers {
  float* mean;       ///< [row], the last solution
  float* nominal;    ///< [row], svg_mppi alone
  float* variance;   ///< [row], svg_mppi alone
  double* theta;     ///< guides of svg_mppi, see GuideMemory
  float* partial;    ///< [group][row, padded]
  GroupSums* sums;   ///< [group]
  unsigned* ticket;  ///< how many blocks have ended, of the samples and of the guides; 0 between solves
  float* costs;      ///< [sample], or null
  float* plan;       ///< [row]
  Report* report;
};

/// Steps by which a sequence moves forward.
struct Shift {
  int whole;
  double part;  ///< [0, 1)
};

/// The argument of every kernel.
template <class P>
struct Arguments {
  alignas(P) unsigned char problem[sizeof(P)];
  float start[detail::state_size<P> + (detail::limits_rates<P> ? P::inputs : 0)];  ///< state, previous input
  Settings settings;
  Buffers buffers;
  unsigned long long seed, stream;  ///< random numbers of the samples
  Shift shift;                      ///< since the last solve
  unsigned solve;                   ///< its number, from 1
};

/// The input of row `r` of a sequence [step][input].
template <class P>
int input_of(int r) {
  return int(unsigned(r) % unsigned(P::inputs));
}

/// Entry `r` of a sequence [step][input] moved forward, as by `shift_sequence`.
template <class P, class Real>
Real shifted(const Arguments<P>& a, const Real* sequence, int r) {
  const int last = a.settings.horizon - 1, i = r % P::inputs, before = r / P::inputs + a.shift.whole;
  if (before >= last) return sequence[last * P::inputs + i];
  const Real x = sequence[before * P::inputs + i], y = sequence[(before + 1) * P::inputs + i];
  return x + Real(a.shift.part) * (y - x);
}

}  // namespace slalom::gpu
