#pragma once

#include <gtest/gtest.h>

#include "slalom/core/problem_evaluator.hpp"

/// Rollouts of batches, on every instruction set.
namespace slalom::testing {

/// Costs and collisions of the samples of a batch, padded.
struct Rollouts {
  std::vector<float> costs;
  std::vector<std::uint8_t> collided;
};

inline Rollouts roll_out(const BatchEvaluator& evaluator, const SequenceBatch& batch) {
  Rollouts made{std::vector<float>(batch.stride()), std::vector<std::uint8_t>(batch.stride())};
  evaluator.evaluate(batch, 0, batch.samples(), made.costs.data(), made.collided.data());
  return made;
}

/// The control sequence of a sample.
template <int M>
std::vector<Input<double, M>> inputs_of(const SequenceBatch& batch, int sample) {
  std::vector<Input<double, M>> u(batch.steps());
  for (int row = 0; row < batch.rows(); ++row) u[row / M][row % M] = batch.data(row)[sample];
  return u;
}

/// The instruction sets that this processor has.
inline std::vector<simd::Target> instruction_sets() {
  std::vector<simd::Target> sets;
  for (const auto set : {simd::Target::generic, simd::Target::sse4, simd::Target::avx2, simd::Target::avx512})
    if (simd::supported(set)) sets.push_back(set);
  return sets;
}

/// Tests on an instruction set; skipped where the processor lacks it.
class OnInstructionSet : public ::testing::TestWithParam<simd::Target> {
 protected:
  void SetUp() override {
    if (!simd::supported(GetParam())) GTEST_SKIP() << "this processor has no " << simd::name(GetParam());
  }
};
#define SLALOM_ON_EVERY_INSTRUCTION_SET(suite)                                                              \
  INSTANTIATE_TEST_SUITE_P(Targets, suite,                                                                  \
                           ::testing::Values(simd::Target::generic, simd::Target::sse4, simd::Target::avx2, \
                                             simd::Target::avx512),                                         \
                           [](const auto& set) { return simd::name(set.param); })

}  // namespace slalom::testing
