// The choices that depend on the processor, and that results do not depend on them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "slalom/core/dispatch.hpp"
#include "slalom/core/grid_view.hpp"
#include "slalom/core/problem_evaluator.hpp"
#include "slalom/core/random.hpp"
#include "slalom/core/simd.hpp"
#include "slalom/core/tuning.hpp"
#include "slalom/problems/differential_drive.hpp"

namespace slalom::simd {
namespace {

struct ReadCells {
  template <class Target>
  SLALOM_KERNEL static void run(const float* cells, const std::int32_t* indices, float* values) {
    using F = Pack<Target>;
    for (int k = 0; k < padding; k += F::lanes) {
      IntPack<Target> index;
      std::memcpy(&index.v, indices + k, sizeof index.v);
      F r[4] = {F(0.0f), F(0.0f), F(0.0f), F(0.0f)};
      Operations<Target>::gather_cells(cells, index.v, r[0].v, r[1].v, r[2].v, r[3].v);
      for (int layer = 0; layer < 4; ++layer) r[layer].store(values + layer * padding + k);
    }
  }
};

class CellReads : public testing::Test {
 protected:
  ~CellReads() override { set_cell_access(before_); }

 private:
  CellAccess before_ = active_cell_access().access;
};

TEST_F(CellReads, GiveTheSameBitsBothWays) {
  constexpr int count = 5000;
  std::vector<float> cells(4 * count);
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = 0.37f * static_cast<float>(i) - 3;
  std::int32_t indices[padding];
  for (int k = 0; k < padding; ++k) indices[k] = k * 7919 % count;
  indices[3] = 0;
  indices[9] = count - 1;
  for (const CellAccess access : {CellAccess::loads, CellAccess::gathers}) {
    SCOPED_TRACE(name(access));
    set_cell_access(access);
    float values[4 * padding] = {};
    kernel<ReadCells>()(cells.data(), indices, values);
    for (int layer = 0; layer < 4; ++layer)
      for (int k = 0; k < padding; ++k)
        EXPECT_EQ(values[layer * padding + k], cells[static_cast<std::size_t>(4 * indices[k] + layer)]);
  }
}

TEST_F(CellReads, AreMeasuredWithoutAChangeOfTheChoice) {
  set_cell_access(CellAccess::gathers);
  const CellAccessChoice choice = measure_cell_access();
  if (!supported(Target::avx512)) {
    EXPECT_EQ(choice.access, CellAccess::loads);
    EXPECT_EQ(choice.loads_ns, 0);
    EXPECT_EQ(choice.gathers_ns, 0);
    return;
  }
  EXPECT_GT(choice.loads_ns, 0);
  EXPECT_GT(choice.gathers_ns, 0);
  EXPECT_EQ(choice.access == CellAccess::gathers, choice.gathers_ns <= 1.03 * choice.loads_ns);
}

TEST(CellAccess, HasNames) {
  EXPECT_STREQ(name(CellAccess::loads), "loads");
  EXPECT_STREQ(name(CellAccess::gathers), "gathers");
}

class PacksOfRollouts : public testing::TestWithParam<Target> {
 protected:
  ~PacksOfRollouts() override { set_packs_in_flight(before_); }

 private:
  PacksInFlight before_ = active_packs_in_flight().packs;
};

TEST_P(PacksOfRollouts, GiveTheSameBitsHoweverManyAreInFlight) {
  if (!supported(GetParam())) GTEST_SKIP() << "this processor has no " << name(GetParam());
  constexpr int samples = 1003;
  SequenceBatch batch(25, 2, samples);
  fill_normal(batch, 0, batch.stride(), {.seed = 3});
  ProblemEvaluator<problems::DifferentialDrive> evaluator({}, GetParam());
  evaluator.set_state({0.1, -0.2, 0.3});
  std::vector<float> costs[2];
  std::vector<std::uint8_t> collided[2];
  for (const int i : {0, 1}) {
    set_packs_in_flight(i == 0 ? PacksInFlight::two : PacksInFlight::four);
    costs[i].resize(padded(samples));
    collided[i].resize(padded(samples));
    evaluator.evaluate(batch, 0, samples, costs[i].data(), collided[i].data());
  }
  EXPECT_GT(costs[0][0], 0);
  // Bits count here, not values.
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison,cert-exp42-c,cert-flp37-c)
  EXPECT_EQ(std::memcmp(costs[0].data(), costs[1].data(), samples * sizeof(float)), 0);
  EXPECT_EQ(std::memcmp(collided[0].data(), collided[1].data(), samples), 0);
}

TEST_P(PacksOfRollouts, AreMeasuredWithoutAChangeOfTheChoice) {
  set_packs_in_flight(PacksInFlight::four);
  const PacksInFlightChoice choice = measure_packs_in_flight(GetParam());
  EXPECT_TRUE(detail::four_packs_in_flight());
  const bool narrow = GetParam() == Target::sse4 || (GetParam() == Target::generic && !Generic::fused);
  if (!narrow || !supported(GetParam())) {
    EXPECT_EQ(choice.packs, PacksInFlight::two);
    EXPECT_EQ(choice.two_ns, 0);
    EXPECT_EQ(choice.four_ns, 0);
    return;
  }
  EXPECT_GT(choice.two_ns, 0);
  EXPECT_GT(choice.four_ns, 0);
  EXPECT_EQ(choice.packs == PacksInFlight::four, choice.two_ns > 1.03 * choice.four_ns);
}

INSTANTIATE_TEST_SUITE_P(Targets, PacksOfRollouts,
                         testing::Values(Target::generic, Target::sse4, Target::avx2, Target::avx512),
                         [](const auto& tested) { return std::string(name(tested.param)); });

TEST(PacksInFlight, HasNames) {
  EXPECT_STREQ(name(PacksInFlight::two), "two");
  EXPECT_STREQ(name(PacksInFlight::four), "four");
}

}  // namespace
}  // namespace slalom::simd
