#pragma once

#include <atomic>

#include "slalom/core/problem_evaluator.hpp"
#include "slalom/gpu/memory.hpp"
#include "slalom/gpu/session.hpp"
#include "slalom/gpu/settings.hpp"
#include "slalom/solvers/solver_base.hpp"

namespace slalom::gpu {

/// A solver on a GPU.
class DeviceSolver : public Solver {
 public:
  /// Copies the contents of the memory that the problem reads again: after a map has changed, before a solve.
  virtual void refresh() noexcept = 0;
  /// Why the device fails; empty if it does not.
  virtual const std::string& fault() const noexcept = 0;
};

/// `mppi` or `svg_mppi` on a GPU, behind the interface of every solver. Only for a `ProblemEvaluator<P>`.
template <class P, class Options>
class GpuSolver final : public DeviceSolver {
  static constexpr bool guided = std::is_same_v<Options, SvgMppiOptions>;
  using Clock = std::chrono::steady_clock;

 public:
  /// The problem gives its bounds. Throws std::invalid_argument on options that a GPU lacks, and DeviceError.
  GpuSolver(const P& problem, const Options& options)
      : seed_(options.seed), shifts_(options.shift_warm_start), session_(images<P>()) {
    std::memset(static_cast<void*>(&a_), 0, sizeof a_);
    const Settings& s = a_.settings = settings_of(problem, options);
    const int rows = s.horizon * P::inputs;
    Buffers& b = a_.buffers;
    allocate(b.mean, rows), allocate(b.nominal, rows), allocate(b.variance, rows);
    allocate(b.theta, guide_doubles(s, rows));
    allocate(b.partial, static_cast<long long>(s.groups) * padded_rows(rows));
    allocate(b.sums, s.groups), allocate(b.ticket, 2), allocate(costs_, s.samples);
    b.report = static_cast<Report*>(session_.allocate(sizeof(Report), true));
    b.plan = static_cast<float*>(session_.allocate(sizeof(float) * size(rows), true));
    samples_ = session_.kernel("slalom_samples", sample_bytes(s, rows));
    if (guided) guides_ = session_.kernel("slalom_guides", guide_bytes(s, rows));
    blocks_ = std::min(s.groups, samples_.resident_blocks);
    session_.require();
    inputs_.resize(size(rows)), variance_.resize(size(rows)), theta_.resize(size(rows * s.guides));
    noise_ = SequenceBatch(s.horizon, P::inputs, std::max(s.guides, 1));
    reset(seed_);
  }

  const char* name() const noexcept override { return Options::method; }
  int horizon() const noexcept override { return a_.settings.horizon; }
  int inputs() const noexcept override { return P::inputs; }
  const SolveResult& result() const noexcept override { return result_; }
  /// Throws: memory and kernels on a device are not copied.
  std::unique_ptr<Solver> clone() const override {
    throw DeviceError("GPU: a controller is not copied; make another");
  }

  /// Copies the memory that the problem reads, and compares costs with those of the processor. Throws
  /// std::invalid_argument if the problem reads memory that it does not declare, or if its costs differ.
  void connect(const BatchEvaluator& evaluator) override {
    constexpr std::size_t beyond = 256;  // read, but not used, behind the weights of a network
    const auto& own = static_cast<const ProblemEvaluator<P>&>(evaluator);
    memory_ = memory_of(own.problem());
    for (SharedMemory& m : memory_) m.copy = session_.allocate(m.data.size() + beyond);
    refresh();
    redirected_ = take_in(own);
    trial(own);
    reset(seed_);
  }

  void reset(std::uint64_t seed) noexcept override {
    const Settings& s = a_.settings;
    a_.seed = seed, a_.stream = 0, a_.shift = {};
    solves_ = 0;
    fill_normal(noise_, 0, padded(s.guides), {seed, 0});
    for (std::size_t r = 0; r < inputs_.size(); ++r) {
      const std::size_t i = r % P::inputs;
      inputs_[r] = std::clamp(0.0f, s.low[i], s.high[i]);
      variance_[r] = s.variance[i];
      for (std::size_t g = 0; g < size(s.guides); ++g) {
        const float z = std::sqrt(float(s.guide_variance[i])) * noise_[int(r)][g];
        theta_[g * inputs_.size() + r] = std::clamp(z, s.low[i], s.high[i]);
      }
    }
    const std::size_t bytes = sizeof(float) * inputs_.size();
    session_.copy_in(a_.buffers.mean, inputs_.data(), bytes);
    session_.copy_in(a_.buffers.nominal, inputs_.data(), bytes);
    session_.copy_in(a_.buffers.variance, variance_.data(), bytes);
    session_.copy_in(a_.buffers.theta, theta_.data(), sizeof(double) * theta_.size());
    session_.synchronize();
    result_ = {};
    result_.inputs = result_.mean = inputs_;
    a_.buffers.report->done = a_.solve = 0;
  }

  const SolveResult& solve(const BatchEvaluator& evaluator, const SolveRequest& request) noexcept override {
    const auto start = Clock::now();
    result_.status = wait(start, request.deadline);  // for a solve that missed its deadline
    if (result_.status != Status::ok) return result_;
    const auto& own = static_cast<const ProblemEvaluator<P>&>(evaluator);
    const bool moved = take_in(own) != redirected_;
    if (moved || !session_.fault().empty()) {
      result_.status = Status::degenerate;
      return result_;
    }
    const double steps = shifts_ ? std::min<double>(warm_start_shift(own, request), a_.settings.horizon) : 0;
    a_.shift = {int(steps), steps - int(steps)};
    a_.stream = (solves_ << 16) | (guided ? 1u : 0u);
    a_.solve = static_cast<unsigned>(++solves_);
    if (guided) session_.launch(guides_, a_.settings.guides, &a_);
    session_.launch(samples_, blocks_, &a_);
    result_.status = wait(start, request.deadline);
    if (result_.status == Status::ok) read(start);
    return result_;
  }

  void refresh() noexcept override {
    for (const SharedMemory& m : memory_) session_.copy_in(m.copy, m.data.data(), m.data.size());
  }
  const std::string& fault() const noexcept override { return session_.fault(); }

 private:
  static constexpr std::size_t size(int count) noexcept { return static_cast<std::size_t>(count); }
  template <class T>
  void allocate(T*& array, long long count) {
    if (count > 0) array = static_cast<T*>(session_.allocate(sizeof(T) * static_cast<std::size_t>(count)));
  }

  /// Takes the problem and the start of its rollouts into the arguments, and lets the problem point to the
  /// copies; returns how many words that changed.
  int take_in(const ProblemEvaluator<P>& evaluator) noexcept {
    std::memcpy(a_.problem, static_cast<const void*>(&evaluator.problem()), sizeof(P));
    std::copy(evaluator.start().begin(), evaluator.start().end(), a_.start);
    int words = 0;
    for (const SharedMemory& m : memory_) words += redirect(a_.problem, m);
    return words;
  }

  /// Compares the costs of up to 1,000 samples around the first solution with those of the processor.
  void trial(const ProblemEvaluator<P>& evaluator) {
    const Settings& s = a_.settings;
    const std::vector<double> variance(s.variance, s.variance + P::inputs);
    const MppiOptions cpu{.horizon = s.horizon,
                          .samples = std::min(s.samples, 1000),
                          .temperature = 1,
                          .variance = variance,
                          .input_min = PerInput(std::vector<double>(s.low, s.low + P::inputs)),
                          .input_max = PerInput(std::vector<double>(s.high, s.high + P::inputs)),
                          .seed = a_.seed};
    const auto solver = make_solver(cpu, P::inputs);
    const std::span<const float> expected = solver->solve(evaluator, {}).costs;
    a_.buffers.costs = costs_;
    std::vector<float> costs(size(s.samples));
    session_.launch(samples_, blocks_, &a_);
    session_.copy_out(costs.data(), costs_, sizeof(float) * costs.size());
    session_.require();
    a_.buffers.costs = nullptr;
    int different = 0, example = 0;
    for (int k = 0; k < cpu.samples; ++k) {
      const float gpu = costs[size(k)], known = expected[size(k)];
      if (gpu != known && !(std::abs(gpu - known) <= 1e-4f * (1 + std::abs(known)))) ++different, example = k;
    }
    if (different <= cpu.samples / 100) return;  // rounding may decide whether a state collides
    throw std::invalid_argument(
        "problem: on the GPU " + std::to_string(different) + " of " + std::to_string(cpu.samples) +
        " samples have other costs than on the processor, for instance " +
        std::to_string(costs[size(example)]) + " instead of " + std::to_string(expected[size(example)]));
  }

  /// Waits until the device has written the plan, the deadline has passed or the device has failed.
  Status wait(Clock::time_point start, double deadline) noexcept {
    constexpr double give_up = 1, ask = 2e-3;  // s
    double next_question = ask;
    if (!session_.fault().empty()) return Status::degenerate;
    const volatile unsigned& done = a_.buffers.report->done;
    for (int turn = 0; done != a_.solve; ++turn) {
      if (turn % 64 != 0) continue;
      const double waited = std::chrono::duration<double>(Clock::now() - start).count();
      if (waited > deadline || waited > give_up) return Status::deadline;
      if (waited < next_question) continue;
      if (!session_.alive()) return Status::degenerate;
      next_question = waited + ask;
    }
    std::atomic_thread_fence(std::memory_order_acquire);
    return Status::ok;
  }

  void read(Clock::time_point start) noexcept {
    std::copy_n(a_.buffers.plan, inputs_.size(), inputs_.data());
    const Report r = *a_.buffers.report;
    const auto samples = static_cast<float>(a_.settings.samples);
    result_.minimum_cost = r.least_cost, result_.expected_cost = r.mean_cost;
    result_.effective_sample_size = r.effective_samples;
    result_.collided_share = r.collided / samples;
    result_.temperature = a_.settings.temperature;
    result_.iterations = guided ? a_.settings.iterations : 1;
    if (r.finite == 0) {
      result_.status = Status::degenerate;
    } else if (r.collided == samples) {
      result_.status = Status::all_collided;
    }
    result_.times.total = std::chrono::duration<double>(Clock::now() - start).count();
  }

  std::uint64_t seed_;  ///< seed of the options
  bool shifts_;
  Session session_;
  std::vector<SharedMemory> memory_;
  Arguments<P> a_;
  float* costs_ = nullptr;  ///< [sample], on the device
  Session::Kernel samples_, guides_;
  int blocks_ = 0;  ///< blocks that roll out the samples
  std::uint64_t solves_ = 0;
  int redirected_ = 0;                    ///< words of the problem that point to copies
  std::vector<float> inputs_, variance_;  ///< [row]
  std::vector<double> theta_;             ///< [guide][row], before the first solve
  SequenceBatch noise_;                   ///< that `theta_` is made of
  SolveResult result_;
};

}  // namespace slalom::gpu
