#pragma once

#include "slalom/gpu/kernels/normal.hpp"
#include "slalom/gpu/kernels/rollout.hpp"
#include "solvers/methods/gaussian_fit.hpp"

/// The guides of `svg_mppi`, a block for each: weights of the costs alone, restarts, samples around the
/// nominal sequence, variances fitted to the path of the best guide; src/solvers/methods/guides.cpp on the
/// processor.
namespace slalom::gpu {

/// Columns of a guide's samples in shared memory, a power of two: the samples and the guide itself, and at
/// the beginning all guides and the last solution.
constexpr int guide_columns(const Settings& s) {
  return 1 << log2_of(1 + (s.gradient_samples > s.guides ? s.gradient_samples : s.guides));
}
/// Floats of shared memory of `MovingGuide`, with one or two arrays of normal values, and of `finish_guides`.
constexpr int guide_floats(const Settings& s, int rows, int arrays) {
  const int columns = guide_columns(s);
  const int least = 4 * s.iterations > 2 * columns ? 4 * s.iterations : 2 * columns;
  return 5 * padded_rows(rows) + arrays * rows * (columns + 1) + least;
}
/// Whether the noise of the next iteration is drawn during the rollouts, which takes a second array.
constexpr bool draws_ahead(const Settings& s, int rows) {
  return guide_floats(s, rows, 2) * 4 <= most_shared_bytes;
}
/// Doubles of device memory: guides before and after a solve, their paths, costs along them and at the end.
constexpr long long guide_doubles(const Settings& s, int rows) {
  return static_cast<long long>(2 + s.iterations) * s.guides * rows + (s.iterations + 1ll) * s.guides;
}

/// The parts of that memory.
template <class P>
struct GuideMemory {
  const Arguments<P>& a;
  const long long each_size = static_cast<long long>(a.settings.guides) * a.settings.horizon * P::inputs;
  double* const before = a.buffers.theta + (a.solve & 1 ? 0 : each_size);  ///< [guide][row]
  double* const after = a.buffers.theta + (a.solve & 1 ? each_size : 0);   ///< [guide][row]
  double* const path = a.buffers.theta + 2 * each_size;                    ///< [guide][row][iteration]
  double* const path_cost = path + a.settings.iterations * each_size;      ///< [guide][iteration]
  double* const end_cost = path_cost + a.settings.iterations * a.settings.guides;  ///< [guide]
};

/// The work of a block on its guide.
template <class P>
struct MovingGuide {
  const Arguments<P>& a;
  const int guide;
  float* const memory;
  const Settings& s = a.settings;
  const GuideMemory<P> m{a};
  const int rows = s.horizon * P::inputs, samples = s.gradient_samples;
  const int columns = guide_columns(s), columns_log2 = log2_of(columns), stride = columns + 1;
  const bool ahead = draws_ahead(s, rows);
  double* const theta = reinterpret_cast<double*>(memory);  ///< [row]
  float* const centre = memory + 2 * padded_rows(rows);     ///< [row]
  float* const deviation = centre + padded_rows(rows);      ///< [row]
  float* const cost = deviation + 2 * padded_rows(rows);    ///< [column]
  float* const weight = cost + columns;                     ///< [column]
  float* const v = weight + columns;                        ///< [row][column]
  float* const noise = ahead ? v + rows * stride : v;       ///< [row][column]

  void run() const {
    begin();
    for (int l = 0; l < s.iterations; ++l) {
      if (!ahead) draw_noise(l, 0), Block::barrier();
      place_samples();
      Block::barrier();
      if (ahead && l + 1 < s.iterations) draw_beside(l + 1, columns);
      // All columns, so that whole warps stay together.
      Block::each(columns, [&](int k) { cost[k] = cost_of(v + k, stride); });
      Block::barrier();
      const float least = Block::least(samples, [&](int k) { return cost[k]; });
      Block::each(samples, [&](int k) {
        weight[k] = least < infinite ? std::exp((least - cost[k]) / s.gradient_temperature) : 0.0f;
      });
      Block::barrier();
      step(l);
      Block::barrier();
    }
    if (Block::thread() == 0)
      m.end_cost[guide] = m.path_cost[(guide + 1) * s.iterations - 1] = cost_of(centre, 1);
  }

 private:
  /// The cost of the sequence values[row * distance].
  float cost_of(const float* values, int distance) const {
    Rollout<P> rollout(a);
    roll_out<unrolled_steps<P>() == 1 ? 1 : 2 * unrolled_steps<P>()>(
        a, rollout, [&](int r) { return values[r * distance]; });
    return rollout.finish();
  }

  /// Starts at the last position, or near the best guide. The last solution replaces the worst guide if it is
  /// better. Every block finds the best and the worst for itself.
  void begin() const {
    const auto old_theta = [&](int g, int r) { return shifted(a, m.before + g * rows, r); };
    const int solution = s.guides;
    Block::each(rows, [&](int r) {
      deviation[r] = sqrtf(s.gradient_variance[input_of<P>(r)]);
      v[r * stride + solution] = shifted(a, a.buffers.mean, r);
      for (int g = 0; g < s.guides; ++g) v[r * stride + g] = float(old_theta(g, r));
    });
    Block::barrier();
    if (ahead) draw_beside(0, s.guides + 1);
    Block::each(s.guides + 1, [&](int k) { cost[k] = cost_of(v + k, stride); });
    Block::barrier();
    int worst = 0, best = 0;
    for (int g = 1; g < s.guides; ++g)
      if (cost[g] > cost[worst]) worst = g;
    const bool replaces = cost[solution] < cost[worst];
    const auto cost_now = [&](int g) { return replaces && g == worst ? cost[solution] : cost[g]; };
    for (int g = 1; g < s.guides; ++g)
      if (cost_now(g) < cost_now(best)) best = g;
    const bool restarts = s.restart && s.guides > 1;
    const int from = restarts ? best : guide;
    Block::each(rows, [&](int r) {
      theta[r] = replaces && from == worst ? double(v[r * stride + solution]) : old_theta(from, r);
    });
    Block::barrier();
    if (restarts && guide > 0) deviate();
    Block::each(rows, [&](int r) { centre[r] = float(theta[r]); });
    Block::barrier();
  }

  /// A smooth deviation, piecewise linear between normal values at four knots.
  void deviate() const {
    const int knots = s.horizon < 4 ? s.horizon : 4, log2 = log2_of(s.guides), width = 1 << log2;
    draw(key_of(a.seed, a.stream - 1 + 65535), knots * P::inputs, 0, log2, width, v, 0,
         [](int, float z) { return z; });
    Block::barrier();
    Block::each(rows, [&](int r) {
      const int i = input_of<P>(r);
      const double position = double(3 * (r / P::inputs)) / s.horizon;
      const int k = int(position), next = k + 1 < s.horizon - 1 ? k + 1 : s.horizon - 1;
      const double part = position - k, z = (1 - part) * v[(k * P::inputs + i) * width + guide] +
                                            part * v[(next * P::inputs + i) * width + guide];
      theta[r] = clamped<double>(theta[r] + sqrt(s.restart_variance[i]) * z, s.low[i], s.high[i]);
    });
    Block::barrier();
  }

  /// Draws the normal values of an iteration; their indices are those of the processor.
  void draw_noise(int l, int busy) const {
    const int block = (s.gradient_samples + 1 + 15) / 16 * 16;
    draw(key_of(a.seed, a.stream + 1 + l), rows, guide * block, columns_log2, stride, noise, busy,
         [](int, float z) { return z; });
  }
  /// Draws by the warps that do not roll out `sequences`, if there are any.
  void draw_beside(int l, int sequences) const {
    const int busy = (sequences + Block::lanes - 1) / Block::lanes * Block::lanes;
    draw_noise(l, busy < Block::threads() ? busy : 0);
  }

  void place_samples() const {
    Block::each(rows * columns, [&](int j) {
      const int r = j >> columns_log2, k = j & (columns - 1), i = input_of<P>(r);
      const float x = clamped(centre[r] + deviation[r] * noise[r * stride + k], s.low[i], s.high[i]);
      v[r * stride + k] = k == samples ? centre[r] : x;
    });
  }

  /// A step along the surrogate gradient.
  void step(int l) const {
    const float sum = Block::sum(samples, [&](int k) { return weight[k]; });
    Block::each(rows, [&](int r) {
      const int i = input_of<P>(r);
      float moment = 0;
      SLALOM_UNROLLED(8)
      for (int k = 0; k < samples; ++k) moment += weight[k] * (v[r * stride + k] - centre[r]);
      const float gradient =
          sum > 0 ? float(double(1.0f / s.gradient_variance[i]) * double(moment) / double(sum)) : 0.0f;
      const double x = clamped<double>(theta[r] + s.guide_step[i] * gradient, s.low[i], s.high[i]);
      theta[r] = x;
      centre[r] = float(x);
      m.path[(static_cast<long long>(guide) * rows + r) * s.iterations + l] = x;
      if (l + 1 == s.iterations) m.after[guide * rows + r] = x;
    });
    if (Block::thread() == 0 && l > 0) m.path_cost[guide * s.iterations + l - 1] = cost[samples];
  }
};

/// Makes the best guide the nominal sequence and fits the variances to its path. The last block does so.
template <class P>
void finish_guides(const Arguments<P>& a, float* memory) {
  const Settings& s = a.settings;
  const GuideMemory<P> m{a};
  const int rows = s.horizon * P::inputs, points = s.iterations;
  double* const square = reinterpret_cast<double*>(memory);  // first the logarithm of the density
  double* const logarithm = square + points;
  int best = 0;
  for (int g = 1; g < s.guides; ++g)
    if (m.end_cost[g] < m.end_cost[best]) best = g;
  const double* const path = m.path + static_cast<long long>(best) * rows * points;
  const double* const theta = m.after + best * rows;
  const auto scaled_cost = [&](int l) { return m.path_cost[best * points + l] / double(s.temperature); };
  for (int l = Block::warp(); l < points; l += Block::warps()) {
    const double distance = Block::sum(rows, [&](int r) {
      const double d = path[r * points + l] - theta[r];
      return d * d * double(float(s.gradient_temperature / s.guide_variance[input_of<P>(r)]));
    });
    square[l] = -scaled_cost(l) - 0.5 * distance / s.gradient_temperature;
  }
  Block::barrier();
  const double largest = -Block::least(points, [&](int l) { return -square[l]; });
  const double all = Block::sum(points, [&](int l) { return exp(square[l] - largest); });
  const double error = -Block::least(points, [&](int l) { return -fabs(scaled_cost(l)); }) *
                       double(std::numeric_limits<float>::epsilon());
  Block::barrier();
  Block::each(points, [&](int l) {
    const double density = exp(square[l] - largest) / all, y = density > 1e-10 ? density : 1e-10;
    square[l] = y * y;
    logarithm[l] = log(y);
  });
  Block::barrier();
  const bool known = m.end_cost[best] < infinite;
  Block::each(rows, [&](int r) {
    const int i = input_of<P>(r);
    double fitted = infinite;
    if (known)
      fitted = detail::fitted_variance(
          detail::fit_gaussian(path + r * points, square, logarithm, points, error), false);
    const double most = s.variance_max[i] > s.variance_min[i] ? s.variance_max[i] : s.variance_min[i];
    a.buffers.variance[r] = float(clamped(fitted, s.variance_min[i], most));
    a.buffers.nominal[r] = known ? float(theta[r]) : shifted(a, a.buffers.mean, r);
  });
}

}  // namespace slalom::gpu
