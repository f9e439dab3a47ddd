#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "suite/task.hpp"

namespace slalom {
namespace {

using suite::Task;

/// The first plans of a task for some seeds on an instruction set, from a process of their own: a process
/// chooses its instruction set once. Empty if that process fails.
std::vector<float> first_plans(const Task& task, simd::Target target, std::size_t seeds) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    setenv("SLALOM_TARGET", simd::name(target), 1);
    for (std::size_t seed = 0; seed < seeds; ++seed) {
      SolverOptions options = suite::default_options("svg_mppi", task);
      *options.find<int>("batches") = 1;  // the choice of a best sample may differ
      const auto plan = task.run({.options = options, .first = seed, .count = 1, .steps = 1}).plan;
      const std::size_t bytes = plan.size() * sizeof(float);
      if (write(ends[1], plan.data(), bytes) != static_cast<ssize_t>(bytes)) _exit(1);
    }
    _exit(0);
  }
  close(ends[1]);
  std::vector<float> plans;
  float value;
  while (read(ends[0], &value, sizeof value) == sizeof value) plans.push_back(value);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return status == 0 ? plans : std::vector<float>{};
}

/// The largest difference of the plans of each seed, in ascending order.
std::vector<double> differences(const std::vector<float>& a, const std::vector<float>& b, std::size_t seeds) {
  std::vector<double> largest(seeds);
  for (std::size_t i = 0; i < a.size(); ++i) {
    double& of_seed = largest[i * seeds / a.size()];
    of_seed = std::max(of_seed, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
  }
  std::sort(largest.begin(), largest.end());
  return largest;
}

/// Rounding may decide whether a sample touches an obstacle: the plans of one seed in ten may differ.
TEST(InstructionSets, GiveTheSameFirstPlans) {
  constexpr std::size_t seeds = 20, alike = 18;
  for (const Task& task : suite::all_tasks()) {
    const auto expected = first_plans(task, simd::Target::generic, seeds);
    ASSERT_EQ(expected.size(), seeds * static_cast<std::size_t>(task.horizon) * task.inputs.size());
    for (const auto target : {simd::Target::sse4, simd::Target::avx2, simd::Target::avx512}) {
      if (!simd::supported(target)) continue;
      const auto plans = first_plans(task, target, seeds);
      ASSERT_EQ(plans.size(), expected.size());
      const auto difference = differences(plans, expected, seeds);
      EXPECT_LT(difference[alike - 1], 1e-3) << task.name << " on " << simd::name(target);
    }
  }
}

}  // namespace
}  // namespace slalom
