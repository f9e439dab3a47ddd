#include <algorithm>
#include <cmath>
#include <limits>

#include "slalom/solvers/default_variances.hpp"
#include "slalom/solvers/sv_mpc_options.hpp"
#include "solvers/kernels/kernels.hpp"
#include "solvers/methods/method_solver.hpp"
#include "solvers/methods/mppi_update.hpp"
#include "solvers/methods/stein.hpp"
#include "solvers/published/published_program.hpp"
#include "solvers/sampling/sample_set.hpp"

namespace slalom {

namespace {

/// `sv_mpc` (Lambert et al., "Stein Variational Model Predictive Control", CoRL 2020): all samples are
/// particles. SVGD moves them towards the posterior of optimal control sequences for a Gaussian prior.
class SvMpcSolver final : public detail::MethodSolver<SvMpcSolver> {
 public:
  SvMpcSolver(const SvMpcOptions& options, int inputs, std::shared_ptr<ThreadPool> pool)
      : MethodSolver(options, inputs, std::move(pool)),
        options_(options),
        particles_(options.horizon, inputs, options.samples),
        gradient_batch_(options.horizon, inputs, particles_.stride() * options.gradient_samples),
        exponents_(gradient_batch_.stride()),
        collided_(exponents_.size()),
        gradient_(options.horizon, inputs, options.samples),
        phi_(options.horizon, inputs, options.samples),
        distances_(std::max(options.samples, 2016)),
        solution_(size()),
        mean_(size()),
        variance_(size()),
        first_variance_(spread(options.variance)),
        min_variance_(spread(options.variance_min)),
        deviation_(spread(options.gradient_variance)),
        inverse_(deviation_),
        prior_inverse_(size()),
        linear_(size()),
        control_(size()),
        step_(spread(options.step)),
        limited_step_(step_),
        zero_(size()),
        particle_(size()),
        sums_(size()) {
    for (std::size_t r = 0; r < size(); ++r) {
      inverse_[r] =
          detail::inverse_variance<float>(deviation_[r], options_.published.inverse_variance_offset);
      deviation_[r] = std::sqrt(deviation_[r]);
    }
    reset(options.seed);
  }

  const char* name() const noexcept override { return SvMpcOptions::method; }
  bool keeps_bounds() const noexcept override { return options_.published.clamp_solution; }

  void reset(std::uint64_t seed) noexcept override {
    restart(seed);
    draw_particles();
    std::fill(solution_.begin(), solution_.end(), 0.0f);
    clamp(solution_.data());
    result_ = {};
    bind_result();
  }

  void compute(const BatchEvaluator& evaluator, const SolveRequest& request,
               const Deadline& deadline) noexcept {
    const auto begin = detail::Clock::now();
    next_solve();  // here, so that the published program's random numbers stay; symptoms are a solve late
    if (options_.shift_warm_start) shift(warm_start_shift(evaluator, request));
    set_prior();
    int iteration = 0;
    const Deadline moving = deadline.part(0.8);  // weights and solution need a final evaluation
    for (; iteration < options_.iterations && !moving.passed(); ++iteration) move(evaluator, iteration);
    result_.times.guide = detail::seconds(begin, detail::Clock::now());

    const detail::BatchStatistics statistics =
        particles_.evaluate(evaluator, control_.data(), pool(), deadline);
    result_.times.evaluate += statistics.evaluate_time;
    const auto evaluated = detail::Clock::now();
    const bool usable = statistics.finite > 0 && finite_particles();
    detail::WeightSums<double> sums;
    result_.guides = {};
    if (usable) {
      sums = particles_.weigh(statistics.minimum_total, static_cast<float>(options_.temperature), pool());
      detail::kernels::scale(static_cast<float>(1.0 / (sums.weight + options_.published.normaliser_offset)),
                             {0, particles_.stride()}, particles_.weights().data());
      update_solution();
    } else {
      std::fill(particles_.weights().begin(), particles_.weights().end(), 0.0f);
    }
    detail::report_samples(particles_, statistics, sums, result_);
    if (!usable && statistics.evaluated > 0) draw_particles();  // this solve repeats the last solution
    result_.temperature = options_.temperature;
    result_.iterations = iteration;
    const bool late = iteration < options_.iterations || statistics.evaluated < particles_.samples();
    const bool all_collided = statistics.collided == particles_.samples();
    result_.status = !usable && statistics.evaluated > 0 ? Status::degenerate
                     : late                              ? Status::deadline
                     : all_collided                      ? Status::all_collided
                                                         : Status::ok;
    result_.times.update = detail::seconds(evaluated, detail::Clock::now());
  }

  /// Lets the result point to this solver's values.
  void bind_result() noexcept {
    result_.inputs = solution_;
    result_.mean = mean_;
    result_.nominal = zero_;
    result_.variances = variance_;
    if (result_.samples) detail::bind_samples(particles_, result_);
  }

 private:
  static constexpr int tile = 128;  ///< particles per task
  int tiles() const noexcept { return (particles_.stride() + tile - 1) / tile; }
  detail::Range range(int t) const noexcept {
    return {t * tile, std::min(tile, particles_.stride() - t * tile)};
  }

  /// Resets the prior and draws the particles around zero.
  void draw_particles() noexcept {
    std::fill(mean_.begin(), mean_.end(), 0.0f);
    std::copy(first_variance_.begin(), first_variance_.end(), variance_.begin());
    for (std::size_t r = 0; r < size(); ++r) particle_[r] = std::sqrt(variance_[r]);
    particles_.draw(key(65535),
                    {mean_.data(), particle_.data(), low().data(), high().data(), particles_.samples()},
                    pool());
  }

  void shift(double steps) noexcept {
    if (!(steps > 0)) return;
    for (std::vector<float>* const values : {&mean_, &solution_, &variance_})
      move_forward(values->data(), steps);
    for (int k = 0; k < particles_.samples(); ++k) {
      particles_.values().get_sample(k, particle_);
      move_forward(particle_.data(), steps);
      particles_.values().set_sample(k, particle_);
    }
  }

  /// Computes what depends on the prior: the inverse of its variances, the step limit, and the control terms
  /// of gradients and weights.
  void set_prior() noexcept {
    for (std::size_t r = 0; r < size(); ++r) {
      prior_inverse_[r] =
          detail::inverse_variance<float>(variance_[r], options_.published.inverse_variance_offset);
      const float curvature = prior_inverse_[r] + inverse_[r];
      limited_step_[r] =
          options_.limit_step && curvature > 0 ? std::min(step_[r], 1.0f / curvature) : step_[r];
      linear_[r] = options_.published.gradient_control_term ? mean_[r] * prior_inverse_[r] : 0.0f;
    }
    detail::control_coefficients(options_.temperature, options_.control_cost_discount,
                                 options_.published.inverse_variance_offset, mean_.data(), zero_.data(),
                                 variance_.data(), rows(), control_.data());
  }

  /// One SVGD step of all particles.
  void move(const BatchEvaluator& evaluator, int iteration) noexcept {
    const int parts = evaluator.whole_batches() ? 1 : tiles();
    const auto part = [&](int t) { return parts == 1 ? detail::Range{0, particles_.stride()} : range(t); };
    pool().run(parts, [&](int t) { estimate_gradients(evaluator, iteration, part(t)); });
    const detail::Rows x = particles_.row_view();
    const int count = particles_.samples();
    const int values = options_.published.bandwidth == BandwidthModel::squared_norms
                           ? detail::squared_norms(x, count, distances_.data())
                           : detail::pair_distances(x, count, distances_.data());
    const float h = count > 1 ? detail::bandwidth(distances_.data(), values, count) : 1.0f;
    pool().run(tiles(), [&](int t) {
      detail::kernels::stein_directions(x, detail::rows_of(gradient_), count, h, range(t),
                                        detail::rows_of(phi_));
    });
    pool().run(tiles(), [&](int t) { step(range(t)); });
  }

  void estimate_gradients(const BatchEvaluator& evaluator, int iteration, detail::Range r) noexcept {
    const int stride = particles_.stride();
    const detail::Rows x = particles_.row_view(), v = detail::rows_of(gradient_batch_);
    for (int s = 0; s < options_.gradient_samples; ++s)
      fill_normal(gradient_batch_, s * stride + r.first, r.count, key(iteration));
    const int biased = zero_mean_from(options_.gradient_samples, options_.zero_mean_share);
    detail::kernels::sample_around(v, x, {nullptr, deviation_.data(), low().data(), high().data(), biased},
                                   stride, options_.gradient_samples, r);
    const int together = evaluator.whole_batches() ? options_.gradient_samples : 1;
    for (int s = 0; s < options_.gradient_samples; s += together)
      evaluator.evaluate(gradient_batch_, s * stride + r.first, together * r.count, exponents_.data(),
                         collided_.data());
    const detail::GradientSettings how{options_.gradient_samples,
                                       stride,
                                       static_cast<float>(options_.temperature),
                                       options_.published.subtract_minimum,
                                       static_cast<float>(options_.published.gradient_floor),
                                       linear_.data(),
                                       inverse_.data()};
    detail::kernels::particle_gradients(how, v, x, r, exponents_.data(), detail::rows_of(gradient_));
    for (int row = 0; row < rows(); ++row) {
      if (!(prior_inverse_[row] > 0)) continue;
      float* g = gradient_.data(row);
      for (int k = r.first; k < r.first + r.count; ++k)
        g[k] += options_.published.inverted_prior
                    ? detail::published_prior_gradient(x.row(row)[k], mean_[row], prior_inverse_[row])
                    : -prior_inverse_[row] * (x.row(row)[k] - mean_[row]);
    }
  }

  void step(detail::Range r) noexcept {
    constexpr float infinite = std::numeric_limits<float>::infinity();
    const bool clamps = options_.published.clamp_particles;
    for (int row = 0; row < rows(); ++row) {
      float* x = particles_.values().data(row);
      const float* direction = phi_.data(row);
      const float least = clamps ? low()[row] : -infinite, most = clamps ? high()[row] : infinite;
      for (int k = r.first; k < r.first + r.count; ++k)
        x[k] = std::min(std::max(x[k] + limited_step_[row] * direction[k], least), most);
    }
  }

  bool finite_particles() noexcept {
    bool finite = true;
    for (int row = 0; row < rows(); ++row)
      for (const float x : particles_.values()[row]) finite &= std::abs(x) < 1e18f;  // squares are finite too
    return finite;
  }

  /// Computes the solution and the prior of the next solve.
  void update_solution() noexcept {
    particles_.weighted_squares(mean_.data(), sums_.data(), pool());
    for (std::size_t r = 0; r < size(); ++r) {
      const double scale = options_.published.dimensionless_variance ? prior_inverse_[r] : 1.0;
      const float least = std::min(min_variance_[r], first_variance_[r]);
      variance_[r] = std::clamp(static_cast<float>(sums_[r] * scale), least, 1e12f);
    }
    particles_.weighted_sums(zero_.data(), sums_.data(), pool());
    std::copy(sums_.begin(), sums_.end(), mean_.begin());
    std::copy(mean_.begin(), mean_.end(), solution_.begin());
    if (options_.best_particle) {
      const auto weights = particles_.weights();
      const auto best = std::max_element(weights.begin(), weights.end()) - weights.begin();
      particles_.values().get_sample(static_cast<int>(best), solution_);
    }
    if (options_.published.clamp_solution) clamp(solution_.data());
  }

  SvMpcOptions options_;
  detail::SampleSet particles_;
  SequenceBatch gradient_batch_;  ///< sample s of particle p at s * stride + p
  AlignedBuffer exponents_;
  std::vector<std::uint8_t> collided_;
  SequenceBatch gradient_, phi_;
  std::vector<float> distances_;
  std::vector<float> solution_, mean_, variance_, first_variance_, min_variance_, deviation_, inverse_,
      prior_inverse_, linear_, control_, step_, limited_step_, zero_, particle_;  ///< [row]
  std::vector<double> sums_;                                                      ///< [row]
};

}  // namespace

std::unique_ptr<Solver> make_solver(const SvMpcOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool) {
  validate_options(options, SvMpcOptions::method, inputs);
  return std::make_unique<SvMpcSolver>(detail::with_variances(options, inputs), inputs, std::move(pool));
}

}  // namespace slalom
