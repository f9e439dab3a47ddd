#include <gtest/gtest.h>

#include "slalom/solvers/make_solver.hpp"
#include "solvers/problems.hpp"
#include "solvers/published_options.hpp"

namespace slalom {
namespace {

using testing::DoubleIntegrator;

struct OptionSet {
  std::string name;
  SolverOptions options;

  friend void PrintTo(const OptionSet& set, std::ostream* out) { *out << set.name; }
};

std::vector<OptionSet> option_sets() {
  std::vector<OptionSet> sets;
  for (const char* name : solver_names()) {
    sets.push_back({name, solver_options(name)});
    sets.push_back({std::string(name) + "_published", testing::published_options(name)});
  }
  return sets;
}

class Contract : public ::testing::TestWithParam<OptionSet> {
 protected:
  /// The options with changes made by `change`, which takes any method's options.
  template <class Change>
  SolverOptions with(Change change) const {
    SolverOptions options = GetParam().options;
    std::visit(change, options);
    return options;
  }
};

TEST_P(Contract, FindsTheOptimumOfALinearQuadraticProblem) {
  const auto solver = make_solver(with([](auto& o) {
                                    o.horizon = 15;
                                    o.input_min = -4;
                                    o.input_max = 4;
                                    o.variance = 0.3;
                                    o.temperature = 0.1;
                                    o.control_cost_discount = 1;
                                    o.zero_mean_share = 0;
                                  }),
                                  1);
  ProblemEvaluator evaluator(DoubleIntegrator{});
  const DoubleIntegrator::State<double> start{0.5, 0.2};
  evaluator.set_state(start);
  for (int i = 0; i < 60; ++i) solver->solve(evaluator, {});
  std::vector<double> mean(15);
  for (int i = 0; i < 400; ++i) {
    const auto& result = solver->solve(evaluator, {});
    ASSERT_EQ(result.status, Status::ok);
    for (std::size_t k = 0; k < 15; ++k) mean[k] += static_cast<double>(result.inputs[k]) / 400;
  }
  const auto optimum = DoubleIntegrator{}.optimum(start, 15);
  for (std::size_t k = 0; k < 15; ++k) EXPECT_NEAR(mean[k], optimum[k], 0.1) << "step " << k;
}

INSTANTIATE_TEST_SUITE_P(Solvers, Contract, ::testing::ValuesIn(option_sets()),
                         [](const auto& set) { return set.param.name; });

}  // namespace
}  // namespace slalom
