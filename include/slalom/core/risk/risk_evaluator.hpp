#pragma once

#include "slalom/core/problem_evaluator.hpp"
#include "slalom/core/risk/risk_measure.hpp"

namespace slalom {

/// A problem with
///
///     void randomize(RandomStream& random) noexcept;
///
/// which turns it into a variant of the world: another friction, mass or delay, a gust for every step,
/// another way of an obstacle. It is called on copies, so it changes what the members hold, and it may draw
/// any number of random values. Copying a problem must not throw.
template <class P>
concept RandomizableProblem = Problem<P> && std::is_nothrow_copy_assignable_v<P> &&
    requires(P& problem, RandomStream& random) {
  problem.randomize(random);
};

/// Evaluates every control sequence in several variants of the world. Its cost is the mean of their costs, or
/// another risk measure of them; it collides if it collides in any. The first variant is the problem itself.
/// The others are made anew at every `set_state`, in pairs from random numbers and their mirror images, so
/// that an odd number of variants deviates to all sides alike. The numbers depend on the seed and the variant
/// alone: all samples meet the same worlds, in every solve and on any number of threads.
///
///     Controller controller{RiskEvaluator{Glider{}, {.variants = 9, .measure = RiskMeasure::cvar}},
///                           SvgMppiOptions{.horizon = 40}};
template <RandomizableProblem P>
class RiskEvaluator final : public BatchEvaluator, private Sampler {
 public:
  using State = detail::StateOf<P, double>;      ///< the problem's state in double
  static constexpr int input_count = P::inputs;  ///< inputs per step

  /// Uses the widest instruction set of the processor, or `target` if given. Throws std::invalid_argument
  /// naming the option, its value and the rule it breaks.
  explicit RiskEvaluator(P problem, const RiskOptions& options, simd::Target target = simd::active_target())
      : options_(options) {
    validate_options(options, "risk");
    variants_.assign(static_cast<std::size_t>(options.variants),
                     ProblemEvaluator<P>(std::move(problem), target));
  }

  /// The problem, to change parameters before `set_state`.
  P& problem() noexcept { return variants_.front().problem(); }
  /// The problem.
  const P& problem() const noexcept { return variants_.front().problem(); }
  /// The problem (index 0) and its variants, as of the last `set_state`.
  const P& variant(int index) const noexcept { return variants_[static_cast<std::size_t>(index)].problem(); }

  /// Sets the state in which the next rollouts start, with variants of the problem as it is now.
  void set_state(const State& state) noexcept {
    variants_.front().set_state(state);
    for (std::size_t m = 1; m < variants_.size(); ++m) {
      RandomStream random({options_.seed, (m + 1) / 2}, m % 2 == 0);
      variants_[m].problem() = problem();
      variants_[m].problem().randomize(random);
      variants_[m].set_state(state);
    }
  }

  /// Sets the input that was applied before the next rollouts, or the remainder, as `ProblemEvaluator` does.
  void set_previous_input(const Input<double, P::inputs>& u) noexcept requires detail::carries_inputs<P> {
    for (ProblemEvaluator<P>& variant : variants_) variant.set_previous_input(u);
  }

  int inputs() const noexcept override { return P::inputs; }
  double time_step() const noexcept override { return variants_.front().time_step(); }
  const Sampler* sampler() const noexcept override { return variants_.front().sampler() ? this : nullptr; }

  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    static_assert(VariantCosts::capacity % simd::padding == 0);
    if (options_.variants == 1) return variants_.front().evaluate(batch, first, count, costs, collided);
    for (int done = 0; done < count; done += VariantCosts::capacity)
      evaluate_part(batch, first + done, std::min(count - done, VariantCosts::capacity), costs, collided);
  }

  /// The states of the problem itself, in double, and the cost as of `evaluate`: the rollouts are in double,
  /// but each variant's cost is rounded to float32, and so is their risk.
  Cost<double> predict(const State& state, const Input<double, P::inputs>* u, int steps,
                       State* x) const noexcept {
    VariantCosts costs;
    bool collided = false;
    for (int m = 0; m < options_.variants; ++m) {
      const Cost<double> cost = slalom::predict(variant(m), state, u, steps, m == 0 ? x : nullptr);
      costs.values[m][0] = static_cast<float>(cost.value);
      collided = collided || cost.collided;
    }
    float risk = 0;
    measure_risk(costs, 1, options_, &risk);
    return {static_cast<double>(risk), collided};
  }

 private:
  void evaluate_part(const SequenceBatch& batch, int first, int count, float* costs,
                     std::uint8_t* collided) const noexcept {
    VariantCosts of_variants;
    std::uint8_t any[VariantCosts::capacity] = {};
    for (int m = 0; m < options_.variants; ++m) {
      variants_[static_cast<std::size_t>(m)].evaluate(batch, first, count, costs, collided);
      std::copy_n(costs + first, count, of_variants.values[m]);
      for (int i = 0; i < count; ++i) any[i] |= collided[first + i];
    }
    measure_risk(of_variants, count, options_, costs + first);
    std::copy_n(any, count, collided + first);
  }

  void fill(SequenceBatch& noise, int first, int count, RandomKey key) const noexcept override {
    if constexpr (detail::samples_itself<P>) problem().sample(noise, first, count, key);
  }

  RiskOptions options_;
  std::vector<ProblemEvaluator<P>> variants_;  ///< the problem itself, then its variants
};

}  // namespace slalom
