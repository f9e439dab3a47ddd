#pragma once

#include "slalom/gpu/kernels/normal.hpp"
#include "slalom/gpu/kernels/rollout.hpp"
#include "solvers/methods/gaussian_fit.hpp"

/// The guides of `svg_mppi`, a block for each: weights of the costs alone, restarts, samples around the
/// nominal sequence, variances fitted to the path of the best guide; src/solvers/methods/guides.cpp on the
/// processor.
namespace slalom::gpu {

/// Samples that the processor draws for a guide; their indices must agree.
constexpr int guide_block(const Settings& s) {
  return (s.gradient_samples + 1 + 15) / 16 * 16;
}
/// Columns of a guide's samples in shared memory, a power of two: the samples and the guide itself, and at
/// the beginning all guides and the last solution.
constexpr int guide_columns(const Settings& s) {
  const int least = s.gradient_samples > s.guides ? s.gradient_samples + 1 : s.guides + 1;
  return 1 << log2_of(least);
}
/// Whether the noise of the next iteration is drawn during the rollouts, which takes a second array.
constexpr bool draws_ahead(const Settings& s, int rows) {
  return 2 * rows * (guide_columns(s) + 1) + 5 * padded_rows(rows) + 2 * guide_columns(s) <= 16384;
}
/// Floats of shared memory of `move_guide`; theta, in double, comes first.
constexpr int guide_floats(const Settings& s, int rows) {
  const int columns = guide_columns(s), arrays = draws_ahead(s, rows) ? 2 : 1;
  const int least = 4 * s.iterations + 4 > 2 * columns ? 4 * s.iterations + 4 : 2 * columns;
  return 5 * padded_rows(rows) + arrays * rows * (columns + 1) + least;
}
/// Doubles of device memory: guides before and after a solve, their paths, costs along the paths and at the
/// end.
constexpr long long guide_doubles(const Settings& s, int rows) {
  return static_cast<long long>(2 + s.iterations) * s.guides * rows + (s.iterations + 1ll) * s.guides;
}

/// Its parts.
template <class P>
struct GuideMemory {
  double *before, *after;  ///< [guide][row]
  double* path;            ///< [guide][row][iteration]
  double* path_cost;       ///< [guide][iteration]
  double* end_cost;        ///< [guide]
  explicit GuideMemory(const Arguments<P>& a) {
    const Settings& s = a.settings;
    const long long each = static_cast<long long>(s.guides) * s.horizon * P::inputs;
    before = a.buffers.theta + (a.solve & 1 ? 0 : each);
    after = a.buffers.theta + (a.solve & 1 ? each : 0);
    path = a.buffers.theta + 2 * each;
    path_cost = path + s.iterations * each;
    end_cost = path_cost + static_cast<long long>(s.iterations) * s.guides;
  }
};

/// The state before the first solve.
template <class P>
void reset(const Arguments<P>& a, float* memory) {
  const Settings& s = a.settings;
  const int rows = s.horizon * P::inputs;
  if (s.guides > 0) {
    const int log2 = log2_of(s.guides), stride = 1 << log2;
    draw(key_of(a.seed, 0), rows, 0, log2, stride, memory, 0, [](int, int, float z) { return z; });
    SLALOM_BARRIER();
    SLALOM_EACH(j, s.guides * rows) {
      const int g = j / rows, r = j - g * rows, i = r % P::inputs;
      a.buffers.theta[j] =
          clamped(sqrtf(float(s.guide_variance[i])) * memory[r * stride + g], s.low[i], s.high[i]);
    }
  }
  SLALOM_EACH(r, rows) {
    a.buffers.mean[r] = clamped(0.0f, s.low[r % P::inputs], s.high[r % P::inputs]);
    a.buffers.nominal[r] = 0.0f;
    a.buffers.variance[r] = s.variance[r % P::inputs];
  }
}

/// The work of a block on its guide.
template <class P>
class MovingGuide {
 public:
  MovingGuide(const Arguments<P>& a, int guide, float* memory)
      : a_(a),
        s_(a.settings),
        m_(a),
        guide_(guide),
        rows_(s_.horizon * P::inputs),
        columns_(guide_columns(s_)),
        columns_log2_(log2_of(columns_)),
        stride_(columns_ + 1),
        samples_(s_.gradient_samples),
        ahead_(draws_ahead(s_, rows_)) {
    const int padded = padded_rows(rows_);
    theta_ = reinterpret_cast<double*>(memory);
    centre_ = memory + 2 * padded;
    deviation_ = centre_ + padded;
    cost_ = deviation_ + 2 * padded;
    weight_ = cost_ + columns_;
    v_ = weight_ + columns_;
    noise_ = ahead_ ? v_ + rows_ * stride_ : v_;
  }

  void run() {
    begin();
    if (!ahead_) draw_noise(0, 0);
    for (int l = 0; l < s_.iterations; ++l) {
      SLALOM_BARRIER();
      place_samples();
      SLALOM_BARRIER();
      roll_out_samples(l);
      SLALOM_BARRIER();
      weigh();
      SLALOM_BARRIER();
      step(l);
      if (!ahead_ && l + 1 < s_.iterations) {
        SLALOM_BARRIER();
        draw_noise(l + 1, 0);
      }
    }
    SLALOM_BARRIER();
    SLALOM_EACH(k, 1) {
      const float cost = cost_of(a_, centre_, 1);
      m_.end_cost[guide_] = cost;
      m_.path_cost[guide_ * s_.iterations + s_.iterations - 1] = cost;
    }
  }

 private:
  double old_theta(int guide, int r) const {
    return shifted(m_.before + guide * rows_, r, s_.horizon, P::inputs, a_.shift);
  }

  /// Starts at the last position, or near the best guide. The last solution replaces the worst guide if it is
  /// better. Every block finds the best and the worst for itself.
  void begin() {
    const int solution = s_.guides;
    SLALOM_EACH(r, rows_) {
      deviation_[r] = sqrtf(s_.gradient_variance[r % P::inputs]);
      v_[r * stride_ + solution] = shifted(a_.buffers.mean, r, s_.horizon, P::inputs, a_.shift);
      for (int g = 0; g < s_.guides; ++g) v_[r * stride_ + g] = float(old_theta(g, r));
    }
    SLALOM_BARRIER();
    if (ahead_) draw_beside(0, s_.guides + 1);
    SLALOM_EACH(k, s_.guides + 1) cost_[k] = cost_of(a_, v_ + k, stride_);
    SLALOM_BARRIER();
    int worst = 0, best = 0;
    for (int g = 1; g < s_.guides; ++g)
      if (cost_[g] > cost_[worst]) worst = g;
    const bool replaces = cost_[solution] < cost_[worst];
    const auto cost = [&](int g) { return replaces && g == worst ? cost_[solution] : cost_[g]; };
    for (int g = 1; g < s_.guides; ++g)
      if (cost(g) < cost(best)) best = g;
    const bool restarts = s_.restart && s_.guides > 1;
    const int from = restarts ? best : guide_;
    SLALOM_EACH(r, rows_)
    theta_[r] = replaces && from == worst ? double(v_[r * stride_ + solution]) : old_theta(from, r);
    SLALOM_BARRIER();
    if (restarts && guide_ > 0) deviate();
    SLALOM_EACH(r, rows_) centre_[r] = float(theta_[r]);
    SLALOM_BARRIER();
  }

  /// A smooth deviation, piecewise linear between normal values at four knots.
  void deviate() {
    const int knots = s_.horizon < 4 ? s_.horizon : 4, log2 = log2_of(s_.guides), stride = 1 << log2;
    draw(key_of(a_.seed, a_.stream - 1 + 65535), knots * P::inputs, 0, log2, stride, v_, 0,
         [](int, int, float z) { return z; });
    SLALOM_BARRIER();
    SLALOM_EACH(r, rows_) {
      const int step = r / P::inputs, i = r - step * P::inputs;
      const double position = double(3 * step) / s_.horizon;
      const int k = int(position), next = k + 1 < s_.horizon - 1 ? k + 1 : s_.horizon - 1;
      const double part = position - k;
      const double z = (1 - part) * v_[(k * P::inputs + i) * stride + guide_] +
                       part * v_[(next * P::inputs + i) * stride + guide_];
      theta_[r] =
          clamped(theta_[r] + sqrt(s_.restart_variance[i]) * z, double(s_.low[i]), double(s_.high[i]));
    }
    SLALOM_BARRIER();
  }

  void draw_noise(int l, int busy) {
    draw(key_of(a_.seed, a_.stream + 1 + l), rows_, guide_ * guide_block(s_), columns_log2_, stride_, noise_,
         busy, [](int, int, float z) { return z; });
  }

  /// Draws by the warps that do not roll out `sequences`, if there are any.
  void draw_beside(int l, int sequences) {
#if SLALOM_ON_GPU
    const int busy = (sequences + 31) / 32 * 32;
    draw_noise(l, busy < int(blockDim.x) ? busy : 0);
#else
    static_cast<void>(sequences);
    draw_noise(l, 0);
#endif
  }

  void place_samples() {
    SLALOM_EACH(j, rows_ * columns_) {
      const int r = j >> columns_log2_, k = j & (columns_ - 1), i = r % P::inputs;
      const float z = noise_[r * stride_ + k];
      v_[r * stride_ + k] =
          k == samples_ ? centre_[r] : clamped(centre_[r] + deviation_[r] * z, s_.low[i], s_.high[i]);
    }
  }

  /// Rolls out all columns, so that whole warps stay together; the others draw the next noise.
  void roll_out_samples(int l) {
    if (ahead_ && l + 1 < s_.iterations) draw_beside(l + 1, columns_);
    SLALOM_EACH(k, columns_) cost_[k] = cost_of(a_, v_ + k, stride_);
  }

  void weigh() {
    const float least = reduce<Least>(samples_, [&](int k) { return cost_[k]; });
    SLALOM_EACH(k, samples_)
    weight_[k] = least < infinite ? std::exp((least - cost_[k]) / s_.gradient_temperature) : 0.0f;
  }

  /// A step along the surrogate gradient.
  void step(int l) {
    const float sum = reduce<Sum>(samples_, [&](int k) { return weight_[k]; });
    SLALOM_EACH(r, rows_) {
      const int i = r % P::inputs;
      const float centre = centre_[r];
      float moment = 0;
#if SLALOM_ON_GPU
#pragma unroll 8
#endif
      for (int k = 0; k < samples_; ++k) moment += weight_[k] * (v_[r * stride_ + k] - centre);
      const float gradient =
          sum > 0 ? float(double(1.0f / s_.gradient_variance[i]) * double(moment) / double(sum)) : 0.0f;
      const double x =
          clamped(theta_[r] + s_.guide_step[i] * gradient, double(s_.low[i]), double(s_.high[i]));
      theta_[r] = x;
      centre_[r] = float(x);
      m_.path[(static_cast<long long>(guide_) * rows_ + r) * s_.iterations + l] = x;
      if (l + 1 == s_.iterations) m_.after[guide_ * rows_ + r] = x;
    }
    SLALOM_ONE_THREAD() if (l > 0) m_.path_cost[guide_ * s_.iterations + l - 1] = cost_[samples_];
  }

  const Arguments<P>& a_;
  const Settings& s_;
  const GuideMemory<P> m_;
  const int guide_, rows_, columns_, columns_log2_, stride_, samples_;
  const bool ahead_;
  double* theta_;               ///< [row]
  float *centre_, *deviation_;  ///< [row]
  float *cost_, *weight_;       ///< [column]
  float *v_, *noise_;           ///< [row][column]
};

/// Makes the best guide the nominal sequence and fits the variances to its path.
template <class P>
void finish_guides(const Arguments<P>& a, float* memory) {
  const Settings& s = a.settings;
  const Buffers& b = a.buffers;
  const GuideMemory<P> m(a);
  const int rows = s.horizon * P::inputs, points = s.iterations;
  double* const square = reinterpret_cast<double*>(memory);  // first the logarithm of the density
  double* const logarithm = square + points;
  int best = 0;
  for (int g = 1; g < s.guides; ++g)
    if (m.end_cost[g] < m.end_cost[best]) best = g;
  const double end_cost = m.end_cost[best];
  const double* const path = m.path + static_cast<long long>(best) * rows * points;
  const double* const theta = m.after + best * rows;
  SLALOM_EACH_WARP(l, points) {
    const double distance = reduce<Sum>(rows, [&](int r) {
      const double d = path[r * points + l] - theta[r];
      return d * d * double(float(s.gradient_temperature / s.guide_variance[r % P::inputs]));
    });
    square[l] =
        -m.path_cost[best * points + l] / double(s.temperature) - 0.5 * distance / s.gradient_temperature;
  }
  SLALOM_BARRIER();
  double largest = square[0], error = 0;
  for (int l = 0; l < points; ++l) {
    largest = square[l] > largest ? square[l] : largest;
    const double cost = fabs(m.path_cost[best * points + l]) / double(s.temperature);
    error = cost > error ? cost : error;
  }
  error *= double(std::numeric_limits<float>::epsilon());
  SLALOM_BARRIER();
  SLALOM_EACH(l, points) square[l] = exp(square[l] - largest);
  SLALOM_BARRIER();
  double all = 0;
  for (int l = 0; l < points; ++l) all += square[l];
  SLALOM_BARRIER();
  SLALOM_EACH(l, points) {
    const double y = square[l] / all > 1e-10 ? square[l] / all : 1e-10;
    square[l] = y * y;
    logarithm[l] = log(y);
  }
  SLALOM_BARRIER();
  const bool known = end_cost < infinite;
  SLALOM_EACH(r, rows) {
    const int i = r % P::inputs;
    double fitted = infinite;
    if (known)
      fitted = detail::fitted_variance(
          detail::fit_gaussian(path + r * points, square, logarithm, points, error), false);
    const double most = s.variance_max[i] > s.variance_min[i] ? s.variance_max[i] : s.variance_min[i];
    b.variance[r] = float(clamped(fitted, s.variance_min[i], most));
    b.nominal[r] = known ? float(theta[r]) : shifted(b.mean, r, s.horizon, P::inputs, a.shift);
  }
}

}  // namespace slalom::gpu
