#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "slalom/core/option_access.hpp"
#include "slalom/solvers/controllers.hpp"
#include "slalom/solvers/registry.hpp"
#include "solvers/problems.hpp"
#include "solvers/set_option.hpp"

/// The option sets over which the contract tests run, and their fixture.
namespace slalom::testing {

inline constexpr double infinite = std::numeric_limits<double>::infinity();

struct OptionSet {
  std::string name;
  SolverOptions options;

  friend void PrintTo(const OptionSet& set, std::ostream* out) { *out << set.name; }
};

/// Whether an option set departs so far from its method that it misses the optimum of a linear-quadratic
/// problem: the published reverse_mppi and sv_mpc draw every variance towards 1, sv_mpc away from its prior.
inline bool published_departs(std::string_view set_name) {
  return set_name == "reverse_mppi_published" || set_name == "sv_mpc_published";
}

/// A method with the options of configs/published.yaml, in which each section has a method's name.
inline SolverOptions published_options(const char* method) {
  SolverOptions options = solver_options(method);
  std::ifstream file(SLALOM_CONFIGS "/published.yaml");
  std::string line;
  while (std::getline(file, line) && line != std::string(method) + ":") {
  }
  while (std::getline(file, line) && line.starts_with("  ")) {
    const std::size_t colon = line.find(": ");
    if (!set_option(options, line.substr(2, colon - 2), line.substr(colon + 2)))
      throw std::logic_error("unknown option " + line);
  }
  return options;
}

/// Every registered method with its defaults, the library's with the published options, and variants of them.
inline std::vector<OptionSet> option_sets() {
  std::vector<OptionSet> sets;
  for (const char* name : solver_names()) sets.push_back({name, solver_options(name)});
  for (const char* name : {"mppi", "svg_mppi", "reverse_mppi", "sv_mpc", "cem"})
    sets.push_back({std::string(name) + "_published", published_options(name)});
  for (OptionSet& s : sets)  // the published sv_mpc promises no bounds
    if (bool* const clamp = s.options.find<bool>("clamp_solution")) *clamp = true;
  const OptionSet variants[] = {
      {"svg_mppi_nominal_only", SvgMppiOptions{.adapt_covariance = false}},
      {"svg_mppi_covariance_only", SvgMppiOptions{.use_nominal = false}},
      {"svg_mppi_neither", SvgMppiOptions{.use_nominal = false, .adapt_covariance = false}},
      {"svg_mppi_five_guides",
       SvgMppiOptions{.guides = {.count = 5, .gradient_temperature = 1, .weight = GuideWeight::importance}}},
      {"svg_mppi_pooled_paths",
       SvgMppiOptions{.guides = {.count = 3}, .published = {.fit_all_guides = true}}},
      {"svg_mppi_around_solution", SvgMppiOptions{.guides = {.count = 1,
                                                             .gradient_samples = 100,
                                                             .restart = false,
                                                             .sample_around = SampleCentre::solution}}},
      {"reverse_mppi_without_rejection", ReverseMppiOptions{.reject_samples = false}},
      {"sv_mpc_best_particle", SvMpcOptions{.best_particle = true}},
      {"cem_send_best", CemOptions{.send_best = true}},
      {"mppi_coloured", MppiOptions{.noise = {.exponent = 1.5}}},
      {"mppi_knots", MppiOptions{.noise = {.knots = 5}}},
      {"mppi_target_ess_fraction", MppiOptions{.weighting = {.target_ess_fraction = 0.03}}},
      {"svg_mppi_all_parts",
       SvgMppiOptions{.noise = {.exponent = 1}, .weighting = {.target_ess_fraction = 0.03}}},
      {"icem_mean", IcemOptions{.send_best = false}},
      {"dial_mpc_all_parts",
       DialMpcOptions{.noise = {.exponent = 1}, .weighting = {.target_ess_fraction = 0.03}}},
      {"svg_mppi_knots", SvgMppiOptions{.noise = {.exponent = 0, .knots = 5}}},
      {"cem_coloured", CemOptions{.noise = {.exponent = 2}}}};
  sets.insert(sets.end(), std::begin(variants), std::end(variants));
  return sets;
}

class SolverContract : public ::testing::TestWithParam<OptionSet> {
 protected:
  /// A solver with changes made to the options by `change(SolverOptions&)`.
  template <class Change>
  std::unique_ptr<Solver> make(int inputs, Change change) const {
    SolverOptions options = GetParam().options;
    change(options);
    return make_solver(options, inputs);
  }
};

/// Small enough for tests over many option sets.
inline constexpr auto small = [](SolverOptions& o) {
  set(o, "horizon", 10);
  set(o, "samples", std::min(*o.find<int>("samples"), 300));
  set(o, "input_min", -2);
  set(o, "input_max", 1);
};

inline void expect_usable(const SolveResult& result, int values, float low, float high) {
  ASSERT_EQ(result.inputs.size(), static_cast<std::size_t>(values));
  for (const float u : result.inputs) {
    EXPECT_TRUE(std::isfinite(u)) << u;
    EXPECT_GE(u, low);
    EXPECT_LE(u, high);
  }
}

/// A cost by the first and the last input of a sequence.
template <class Cost>
auto simple(int inputs, Cost cost) {
  return FunctionEvaluator(inputs, [cost](const SequenceBatch& batch, int k) {
    return std::pair<double, bool>(cost(batch.at(0, 0, k), batch.at(batch.steps() - 1, 0, k), k), false);
  });
}

}  // namespace slalom::testing
