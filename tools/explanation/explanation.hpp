#pragma once

#include "slalom/problems/passing_point.hpp"
#include "slalom/solvers/registry.hpp"

/// Shows how a method solves the smallest problem with two homotopy classes, `problems::PassingPoint`.
namespace slalom::tools {

/// The lateral position (m, left is positive) at every state of a rollout.
using Way = std::vector<double>;

struct ExplainedSample {
  Way way;
  double cost = 0, weight = 0;
  bool collided = false;
};

struct Explanation {
  std::string method{}, about{};
  problems::PassingPoint point{};
  int beside = 0;  ///< the state at which the point is beside the disc

  std::vector<ExplainedSample> samples{};
  std::vector<std::vector<Way>> guides{};  ///< ways of each guide after every step
  int best_guide = -1;  ///< index of the guide that is the nominal sequence; -1 without guides
  Way plan{};           ///< way of the sequence that would be sent
  bool plan_collides = false;
  Way mean{};                       ///< mean of the resulting distribution
  std::vector<double> deviation{};  ///< standard deviation of the distribution, m, at every state
  double effective_samples = 0;

  /// The optimal distribution of the place beside the disc, q*(v) ~ exp(-S(v)) N(v | 0, 1).
  std::vector<double> places{}, density{};  ///< m, 1/m
};

/// Solves once and explains the solve. `about`: a few words on the method. The options get a horizon of 20
/// steps, inputs within 3 m/s, and variance and temperature 1.
Explanation explain(SolverOptions options, const std::string& about, std::uint64_t seed);

}  // namespace slalom::tools
