#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <memory>

#include "slalom/core/problem_evaluator.hpp"
#include "slalom/gpu/memory.hpp"
#include "slalom/gpu/session.hpp"
#include "slalom/gpu/settings.hpp"
#include "slalom/solvers/solver_base.hpp"

namespace slalom::gpu {

/// `mppi` or `svg_mppi` on a GPU, behind the interface of every solver. Only for a `ProblemEvaluator<P>`.
template <class P, class Options>
class GpuSolver final : public Solver {
  static constexpr bool guided = std::is_same_v<Options, SvgMppiOptions>;
  using Clock = std::chrono::steady_clock;

 public:
  /// Throws std::invalid_argument on options that a GPU lacks, and DeviceError.
  explicit GpuSolver(const Options& options)
      : options_(options),
        session_(images<P>(), {int(sizeof(P)), int(alignof(P)), int(sizeof(Arguments<P>)), P::inputs}) {
    std::memset(static_cast<void*>(&a_), 0, sizeof a_);
    const Settings& s = a_.settings = settings_of(options, P::inputs);
    const int rows = s.horizon * P::inputs;
    const std::size_t row_bytes = sizeof(float) * static_cast<std::size_t>(padded_rows(rows));
    const auto floats = [&](std::size_t bytes) { return reinterpret_cast<float*>(session_.allocate(bytes)); };
    Buffers& b = a_.buffers;
    state_bytes_ = 3 * row_bytes;
    if (guided) state_bytes_ += sizeof(double) * static_cast<std::size_t>(guide_doubles(s, rows));
    b.mean = floats(state_bytes_), b.nominal = b.mean + row_bytes / sizeof(float);
    b.variance = b.nominal + row_bytes / sizeof(float);
    b.theta = reinterpret_cast<double*>(b.variance + row_bytes / sizeof(float));
    b.partial = floats(row_bytes * static_cast<std::size_t>(s.groups));
    b.sums = reinterpret_cast<GroupSums*>(
        session_.allocate(sizeof(GroupSums) * static_cast<std::size_t>(s.groups)));
    b.ticket = reinterpret_cast<unsigned*>(session_.allocate(256));
    costs_ = floats(sizeof(float) * static_cast<std::size_t>(s.samples));
    Session::Address host = 0;
    auto* const memory = static_cast<char*>(session_.allocate_on_host(row_bytes + 256, host));
    report_ = reinterpret_cast<Report*>(memory), plan_ = reinterpret_cast<float*>(memory + 256);
    b.report = reinterpret_cast<Report*>(host), b.plan = reinterpret_cast<float*>(host + 256);

    sample_bytes_ = 4 * sample_floats(s, rows), guide_bytes_ = 4 * guide_floats_of(s, rows);
    samples_ = session_.kernel(guided ? "slalom_svg_mppi" : "slalom_mppi", block_threads, sample_bytes_);
    guides_ = session_.kernel("slalom_guides", block_threads, guide_bytes_);
    reset_ = session_.kernel("slalom_reset", block_threads, guide_bytes_);
    blocks_ = std::min(s.groups, session_.resident_blocks(samples_, block_threads, sample_bytes_));
    inputs_.resize(static_cast<std::size_t>(rows));
    reset(options.seed);
  }

  const char* name() const noexcept override { return Options::method; }
  int horizon() const noexcept override { return a_.settings.horizon; }
  int inputs() const noexcept override { return P::inputs; }
  const SolveResult& result() const noexcept override { return result_; }

  std::unique_ptr<Solver> clone() const override {
    auto copy = std::make_unique<GpuSolver>(options_);
    std::vector<char> state(state_bytes_);
    session_.copy_out(state.data(), address(a_.buffers.mean), state_bytes_);
    copy->session_.copy_in(address(copy->a_.buffers.mean), state.data(), state_bytes_);
    copy->a_.seed = a_.seed;
    copy->solves_ = solves_;
    copy->share(memory_);
    copy->redirected_ = redirected_;
    copy->inputs_ = inputs_;
    copy->result_ = result_;
    copy->bind();
    return copy;
  }

  void reset(std::uint64_t seed) noexcept override {
    a_.seed = seed;
    solves_ = 0;
    for (std::size_t r = 0; r < inputs_.size(); ++r) {
      const std::size_t i = r % P::inputs;
      inputs_[r] = std::clamp(0.0f, a_.settings.low[i], a_.settings.high[i]);
    }
    result_ = {};
    bind();
    a_.solve = 0;
    session_.launch(reset_, 1, block_threads, guide_bytes_, &a_);
    session_.synchronize();
    report_->done = 0;
  }

  /// Finds the memory that the problem reads, and compares costs with those of the processor. Throws
  /// std::invalid_argument if the problem reads memory that it does not declare, or if the costs differ.
  void connect(const BatchEvaluator& evaluator) override {
    const P& problem = problem_of_evaluator(evaluator);
    share(memory_of(problem));
    std::memcpy(a_.problem, static_cast<const void*>(&problem), sizeof problem);
    redirected_ = redirect_all();
    trial(evaluator);
    reset(options_.seed);
  }

  const SolveResult& solve(const BatchEvaluator& evaluator, const SolveRequest& request) noexcept override {
    const auto start = Clock::now();
    result_.status = wait(start, request.deadline);  // for a solve that missed its deadline
    if (result_.status != Status::ok) return result_;
    enqueue(evaluator, options_.shift_warm_start ? warm_start_shift(evaluator, request) : 0);
    result_.status = moved_ ? Status::degenerate : wait(start, request.deadline);
    if (result_.status == Status::ok) read(start);
    return result_;
  }

  /// Copies the contents of the memory that the problem reads again: after a map has changed, before a solve.
  void refresh() noexcept {
    for (std::size_t i = 0; i < memory_.size(); ++i)
      if (memory_[i].bytes > 0) session_.refresh(copies_[i], memory_[i].data, memory_[i].bytes);
  }

  /// The session on the device.
  const Session& session() const noexcept { return session_; }

  /// For benchmarks: queues a solve without waiting for it.
  void enqueue(const BatchEvaluator& evaluator, double shift) noexcept {
    const P& problem = problem_of_evaluator(evaluator);
    std::memcpy(a_.problem, static_cast<const void*>(&problem), sizeof problem);
    moved_ = redirect_all() != redirected_;
    const auto from = static_cast<const ProblemEvaluator<P>&>(evaluator).start();
    std::copy(from.begin(), from.end(), a_.start);
    if (moved_ || !session_.fault().empty()) return;
    a_.stream = (solves_ << 16) | (guided ? 1u : 0u);
    a_.shift = Shift::of(shift, a_.settings.horizon);
    a_.solve = static_cast<unsigned>(++solves_);
    if (guided) session_.launch(guides_, a_.settings.guides, block_threads, guide_bytes_, &a_);
    session_.launch(samples_, blocks_, block_threads, sample_bytes_, &a_);
  }
  /// Waits for queued solves.
  bool synchronize() noexcept { return session_.synchronize(); }
  /// Blocks of a launch.
  int blocks() const noexcept { return blocks_; }
  /// For tests: another number of blocks, as on a smaller device; the results must not change.
  void set_blocks(int blocks) noexcept { blocks_ = std::min(blocks, blocks_); }

 private:
  static const P& problem_of_evaluator(const BatchEvaluator& evaluator) noexcept {
    return static_cast<const ProblemEvaluator<P>&>(evaluator).problem();
  }

  void share(std::vector<SharedMemory> memory) {
    constexpr std::size_t beyond = 256;  // read, but not used, behind the weights of a network
    memory_ = std::move(memory);
    copies_.clear();
    for (const SharedMemory& m : memory_) {
      copies_.push_back(session_.allocate(m.bytes + beyond));
      if (m.bytes > 0) session_.copy_in(copies_.back(), m.data, m.bytes);
    }
  }
  /// Lets the problem in the arguments point to the copies; returns how many words it changed.
  int redirect_all() noexcept {
    int words = 0;
    for (std::size_t i = 0; i < memory_.size(); ++i) words += redirect(a_.problem, memory_[i], copies_[i]);
    return words;
  }

  /// Compares the costs of the first samples of a solve with those of the processor.
  void trial(const BatchEvaluator& evaluator) {
    const Settings& s = a_.settings;
    const int rows = s.horizon * P::inputs, count = std::min(s.samples, 1000);
    std::vector<float> mean = inputs_, variance(inputs_.size());
    for (std::size_t r = 0; r < variance.size(); ++r) variance[r] = s.variance[r % P::inputs];
    a_.buffers.costs = costs_;
    enqueue(evaluator, 0);
    std::vector<float> costs(static_cast<std::size_t>(s.samples));
    session_.copy_out(costs.data(), address(costs_), sizeof(float) * costs.size());  // waits
    a_.buffers.costs = nullptr;
    if (guided) {
      session_.copy_out(mean.data(), address(a_.buffers.nominal), sizeof(float) * mean.size());
      session_.copy_out(variance.data(), address(a_.buffers.variance), sizeof(float) * mean.size());
    }
    SequenceBatch batch(s.horizon, P::inputs, count);
    fill_normal(batch, 0, count, {a_.seed, a_.stream});
    for (int r = 0; r < rows; ++r) {
      const auto at = static_cast<std::size_t>(r);
      for (int k = 0; k < count; ++k) {
        float& value = batch.data(r)[k];
        value =
            clamped(mean[at] + std::sqrt(variance[at]) * value, s.low[r % P::inputs], s.high[r % P::inputs]);
      }
    }
    std::vector<float> expected(static_cast<std::size_t>(batch.stride()));
    std::vector<std::uint8_t> collided(expected.size());
    evaluator.evaluate(batch, 0, count, expected.data(), collided.data());
    int different = 0, example = 0;
    for (int k = 0; k < count; ++k) {
      const float gpu = costs[static_cast<std::size_t>(k)], cpu = expected[static_cast<std::size_t>(k)];
      const bool alike =
          std::abs(gpu - cpu) <= 1e-4f * (1 + std::abs(cpu)) || (!std::isfinite(cpu) && gpu == infinite);
      if (!alike) ++different, example = k;
    }
    if (different <= count / 100) return;  // rounding may decide whether a state collides
    const auto at = static_cast<std::size_t>(example);
    throw std::invalid_argument("problem: on the GPU " + std::to_string(different) + " of " +
                                std::to_string(count) +
                                " samples have other costs than on the processor, for instance " +
                                std::to_string(costs[at]) + " instead of " + std::to_string(expected[at]));
  }

  /// Waits until the device has written the plan, the deadline has passed or the device has failed.
  Status wait(Clock::time_point start, double deadline) noexcept {
    constexpr double give_up = 1, ask = 2e-3;  // s
    double next_question = ask;
    if (!session_.fault().empty()) return Status::degenerate;
    const volatile unsigned& done = report_->done;
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
    std::copy_n(plan_, inputs_.size(), inputs_.data());
    const Report r = *report_;
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

  void bind() noexcept { result_.inputs = result_.mean = inputs_; }
  template <class T>
  static Session::Address address(const T* pointer) noexcept {
    return reinterpret_cast<Session::Address>(pointer);
  }

  Options options_;
  mutable Session session_;
  Arguments<P> a_;
  float* costs_ = nullptr;
  Report* report_ = nullptr;
  const float* plan_ = nullptr;
  void *samples_ = nullptr, *guides_ = nullptr, *reset_ = nullptr;
  int sample_bytes_ = 0, guide_bytes_ = 0, blocks_ = 0;
  std::size_t state_bytes_ = 0;  ///< mean, nominal, variance and theta
  std::uint64_t solves_ = 0;
  std::vector<SharedMemory> memory_;
  std::vector<Session::Address> copies_;
  int redirected_ = 0;  ///< words of the problem that point to copies
  bool moved_ = false;  ///< whether the problem points elsewhere now
  std::vector<float> inputs_;
  SolveResult result_;
};

}  // namespace slalom::gpu
