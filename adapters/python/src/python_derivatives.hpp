#pragma once

#include <algorithm>

#include "controller.hpp"
#include "slalom/solvers/ilqr.hpp"

namespace slalom::python {

/// The values, of which there must be `count`. Throws std::invalid_argument that names them as `what`.
inline std::vector<double> checked(std::vector<double> values, int count, const char* what) {
  if (static_cast<int>(values.size()) != count)
    throw std::invalid_argument(std::string(what) + ": has " + std::to_string(values.size()) +
                                " values, must have " + std::to_string(count));
  return values;
}

/// The derivatives of a problem in Python, for feedback and iterative LQR.
class PythonDerivatives final : public DifferentiableProblem {
 public:
  explicit PythonDerivatives(AnyProblem& problem) : problem_(problem) {}

  void step(int, std::span<const double> x, std::span<const double> u, std::span<double> next) override {
    const std::vector<double> following = problem_.step(x, u);
    std::copy(following.begin(), following.end(), next.begin());
  }
  double cost(std::span<const double> x, std::span<const double> inputs) override {
    return problem_.predict(x, inputs).cost;
  }
  bool expand_step(int, const FeedbackGains::Step& at) override {
    const Derivatives d = problem_.derivatives(at.state, at.inputs);
    std::copy(d.state_jacobian.begin(), d.state_jacobian.end(), at.state_jacobian.begin());
    std::copy(d.input_jacobian.begin(), d.input_jacobian.end(), at.input_jacobian.begin());
    std::copy(d.gradient.begin(), d.gradient.end(), at.gradient.begin());
    std::copy(d.hessian.begin(), d.hessian.end(), at.hessian.begin());
    return d.kink;
  }
  bool expand_end(const FeedbackGains::Terminal& at) override {
    const Derivatives d = problem_.terminal_derivatives(at.state);
    std::copy(d.gradient.begin(), d.gradient.end(), at.gradient.begin());
    std::copy(d.hessian.begin(), d.hessian.end(), at.hessian.begin());
    return d.kink;
  }

 private:
  AnyProblem& problem_;
};

}  // namespace slalom::python
