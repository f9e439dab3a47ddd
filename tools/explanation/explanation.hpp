#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slalom/problems/passing_point.hpp"
#include "slalom/solvers/registry.hpp"

/// Explains how a method solves the smallest problem with two homotopy classes, `problems::PassingPoint`.
namespace slalom::tools {

/// The lateral position (m, left is positive) at every state of a rollout.
using Way = std::vector<double>;

struct ExplainedSample {
  Way way;
  double cost = 0, weight = 0;
  bool collided = false;
};

struct Explanation {
  std::string method, about;
  std::string status;
  Symptom symptom = Symptom::none;  ///< suspicion of the last solve; never no_progress, as the point stays
  problems::PassingPoint point;
  int beside = 0;  ///< the state at which the point is beside the disc
  int solves = 0;

  std::vector<ExplainedSample> samples;  ///< samples of the last solve
  std::vector<std::vector<Way>> guides;  ///< ways of each guide after every step in all solves
  int best_guide = -1;         ///< index of the guide that is the nominal sequence; -1 without guides
  Way plan;                    ///< way of the sequence that would be sent
  std::vector<double> inputs;  ///< m/s, that sequence
  double plan_cost = 0;
  bool plan_collides = false;
  Way mean;                       ///< mean of the resulting distribution
  std::vector<double> deviation;  ///< standard deviation of the distribution, m, at every state
  double temperature = 0;         ///< temperature of the optimal distribution beside it
  double effective_samples = 0;

  /// The optimal distribution of the place beside the disc, q*(v) ~ exp(-S(v) / lambda) N(v | 0, Sigma).
  std::vector<double> places, density;  ///< m, 1/m
};

/// Methods by the names that can be explained: every solver, and the ablations `svg_mppi_nominal`,
/// `svg_mppi_covariance`.
struct ExplainedMethod {
  std::string name, about;
  SolverOptions options;
};
std::vector<ExplainedMethod> explained_methods();

/// Solves `solves` times from the same state and explains the last solve.
/// Throws std::invalid_argument where an option is out of range.
Explanation explain(const ExplainedMethod& method, const problems::PassingPoint& point, int solves,
                    std::uint64_t seed);

}  // namespace slalom::tools
