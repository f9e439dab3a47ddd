#include "solvers/c_uniform/level_flow.hpp"

#include <gtest/gtest.h>

namespace slalom {
namespace {

TEST(LevelFlow, FindsTheMostEvenMassesWhereUniformOnesAreOutOfReach) {
  // The first cell reaches only the first target, so half of the mass stays there.
  detail::LevelFlow flow;
  flow.supply = {0.5, 0.5};
  flow.first = {0, 1, 4};
  flow.target = {0, 0, 1, 2};
  flow.mass.resize(3);
  flow.start();
  EXPECT_GT(flow.mass[0], 0.55);
  EXPECT_LT(flow.level_out(100, 1e-12), 100);
  EXPECT_NEAR(flow.mass[0], 0.5, 1e-9);
  EXPECT_NEAR(flow.mass[1], 0.25, 1e-9);
  EXPECT_NEAR(flow.mass[2], 0.25, 1e-9);
  EXPECT_NEAR(flow.gap(), 0, 1e-12);
}

TEST(LevelFlow, MovesMassAlongAChain) {
  constexpr int cells = 40;
  detail::LevelFlow flow;
  flow.supply.assign(cells, 1.0 / cells);
  flow.mass.resize(cells + 1);
  for (int i = 0; i < cells; ++i) {
    flow.first.push_back(2 * i);
    flow.target.insert(flow.target.end(), {i, i + 1});
  }
  flow.first.push_back(2 * cells);
  flow.start();
  const double gap = flow.gap();
  flow.level_out(5000, 1e-9);
  EXPECT_LT(flow.gap(), 1e-6 * gap);
  for (const double mass : flow.mass) EXPECT_NEAR(mass, 1.0 / (cells + 1), 1e-4 / cells);
}

}  // namespace
}  // namespace slalom
