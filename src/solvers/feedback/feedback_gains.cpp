#include "slalom/solvers/feedback_gains.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "slalom/core/option_access.hpp"
#include "slalom/solvers/differentiable_problem.hpp"
#include "solvers/all_finite.hpp"
#include "solvers/feedback/symmetric_matrix.hpp"

namespace slalom {
namespace {

using detail::all_finite;
using detail::SquareMatrix;

std::size_t count(int a, int b = 1, int c = 1) {
  return static_cast<std::size_t>(a) * static_cast<std::size_t>(b) * static_cast<std::size_t>(c);
}

std::span<double> part(std::vector<double>& all, int index, std::size_t size) {
  return std::span(all).subspan(static_cast<std::size_t>(index) * size, size);
}

/// Added to the diagonal of a matrix that may be singular, relative to its largest entry there.
constexpr double ridge = 1e-10;

}  // namespace

FeedbackGains::FeedbackGains(int states, int inputs, int steps, const InputBounds& bounds)
    : states_(states), inputs_(inputs), steps_(steps), bounds_(bounds) {
  const auto require = [](int value, const char* what) {
    if (value < 1)
      throw std::invalid_argument(std::string("feedback: ") + what + ": " + std::to_string(value) +
                                  " must be at least 1");
  };
  require(states, "number of states");
  require(inputs, "number of inputs");
  require(steps, "number of steps");
  if (bounds.low.size() != count(inputs) || bounds.high.size() != count(inputs))
    throw std::invalid_argument("feedback: bounds: must be given for each of " + std::to_string(inputs) +
                                " inputs");
  for (std::size_t i = 0; i < count(inputs); ++i)
    if (!(bounds.low[i] <= bounds.high[i]))
      throw std::invalid_argument("feedback: bounds: the lower bound of input " + std::to_string(i) + ", " +
                                  to_text(bounds.low[i]) + ", must be at most the upper bound, " +
                                  to_text(bounds.high[i]));
  const int all = states + inputs;
  plan_states_.resize(count(steps + 1, states));
  plan_inputs_.resize(count(steps, inputs));
  for (std::size_t i = 0; i < plan_inputs_.size(); ++i)
    plan_inputs_[i] = bounds.nearest(i % count(inputs), 0);
  jacobians_.resize(count(steps, states, all));
  gradients_.resize(count(steps, all) + count(states));
  hessians_.resize(count(steps, all, all) + count(states, states));
  gains_.resize(count(steps, inputs, states));
  changes_.resize(count(steps, inputs));
  value_.resize(count(states, states));
  value_gradient_.resize(count(states));
  hessian_.resize(count(all, all));
  gradient_.resize(count(all));
  product_.resize(count(states, all));
  matrix_.resize(count(all, all));
  vectors_.resize(count(all, all));
  free_.resize(count(inputs));
}

FeedbackGains::Step FeedbackGains::step(int k) noexcept {
  const int all = states_ + inputs_;
  const std::span<double> jacobians = part(jacobians_, k, count(states_, all));
  return {part(plan_states_, k, count(states_)),    part(plan_inputs_, k, count(inputs_)),
          jacobians.first(count(states_, states_)), jacobians.subspan(count(states_, states_)),
          part(gradients_, k, count(all)),          part(hessians_, k, count(all, all))};
}

FeedbackGains::Terminal FeedbackGains::terminal() noexcept {
  return {std::span(plan_states_).last(count(states_)), std::span(gradients_).last(count(states_)),
          std::span(hessians_).last(count(states_, states_))};
}

std::span<const double> FeedbackGains::gain(int k) const noexcept {
  return std::span(gains_).subspan(count(k, inputs_, states_), count(inputs_, states_));
}

std::span<const double> FeedbackGains::change(int k) const noexcept {
  return std::span(changes_).subspan(count(k, inputs_), count(inputs_));
}

bool FeedbackGains::expand(DifferentiableProblem& problem) {
  bool kink = false;
  for (int k = 0; k < steps_; ++k) kink |= problem.expand_step(k, step(k));
  kink |= problem.expand_end(terminal());
  return kink;
}

/// The nearest positive semidefinite matrix: negative eigenvalues become 0.
void FeedbackGains::make_semidefinite(std::span<double> matrix, int size) noexcept {
  const SquareMatrix a{matrix, size}, copy{std::span(matrix_).first(matrix.size()), size};
  double largest = 0;
  for (int i = 0; i < size; ++i) largest = std::max(largest, std::abs(a(i, i)));
  const auto take = [&] {
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j) copy(i, j) = 0.5 * (a(i, j) + a(j, i));
  };
  take();
  for (int i = 0; i < size; ++i) copy(i, i) += ridge * largest;
  if (factorise(copy)) return;
  take();
  const SquareMatrix v{std::span(vectors_).first(matrix.size()), size};
  diagonalise(copy, v);
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) {
      a(i, j) = 0;
      for (int k = 0; k < size; ++k) a(i, j) += v(i, k) * std::max(copy(k, k), 0.0) * v(j, k);
    }
  }
}

/// Hessian and gradient of the cost to go by state and inputs of step `k`: those of its stage cost plus those
/// of the cost to go from the next state.
void FeedbackGains::begin_step(int k) noexcept {
  const int n = states_, all = states_ + inputs_;
  const Step s = step(k);
  make_semidefinite(s.hessian, all);
  const auto jacobian = [&](int row, int column) {  // [A B]
    return column < n ? s.state_jacobian[count(row, n) + count(column)]
                      : s.input_jacobian[count(row, inputs_) + count(column - n)];
  };
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < all; ++column) {
      double sum = 0;
      for (int i = 0; i < n; ++i) sum += value_[count(row, n) + count(i)] * jacobian(i, column);
      product_[count(row, all) + count(column)] = sum;
    }
  }
  for (int row = 0; row < all; ++row) {
    for (int column = 0; column < all; ++column) {
      double sum = s.hessian[count(row, all) + count(column)];
      for (int i = 0; i < n; ++i) sum += jacobian(i, row) * product_[count(i, all) + count(column)];
      hessian_[count(row, all) + count(column)] = sum;
    }
    double sum = s.gradient[count(row)];
    for (int i = 0; i < n; ++i) sum += jacobian(i, row) * value_gradient_[count(i)];
    gradient_[count(row)] = sum;
  }
}

/// Lists the inputs that may move: all but those at a bound beyond which the cost would fall.
int FeedbackGains::choose_free_inputs(int k) noexcept {
  const std::span<const double> u = part(plan_inputs_, k, count(inputs_));
  int free = 0;
  for (int i = 0; i < inputs_; ++i) {
    const double low = bounds_.low[count(i)], high = bounds_.high[count(i)],
                 slope = gradient_[count(states_ + i)];
    const auto near = [&](double bound) {  // the plan's inputs were computed in float32
      return std::isfinite(bound) && std::abs(u[count(i)] - bound) <= 1e-6 * (1 + std::abs(bound));
    };
    if ((near(low) && slope > 0) || (near(high) && slope < 0)) continue;
    free_[count(free++)] = i;
  }
  return free;
}

/// The Cholesky factor of Quu for the free inputs, in `matrix_`. Returns false if there is none. If the cost
/// does not depend on them, no input is free.
bool FeedbackGains::factorise_free(int& free, double damping) noexcept {
  const SquareMatrix h{hessian_, states_ + inputs_}, quu{std::span(matrix_).first(count(free, free)), free};
  double largest = 0;
  for (int i = 0; i < free; ++i) {
    for (int j = 0; j < free; ++j) quu(i, j) = h(states_ + free_[count(i)], states_ + free_[count(j)]);
    largest = std::max(largest, quu(i, i));
  }
  if (largest == 0) free = 0;
  for (int i = 0; i < free; ++i) quu(i, i) += damping * quu(i, i) + ridge * largest;
  return free == 0 || factorise(quu);
}

/// The change of the inputs -Quu^-1 Qu. Inputs that it would move out of their bounds end at them and are no
/// longer free; then the others are solved for again.
bool FeedbackGains::solve_change(int k, int& free, double damping) noexcept {
  const SquareMatrix h{hessian_, states_ + inputs_};
  const std::span<double> change = part(changes_, k, count(inputs_));
  const std::span<const double> u = part(plan_inputs_, k, count(inputs_));
  double* const solution = vectors_.data();
  while (free > 0) {
    if (!factorise_free(free, damping)) return false;
    for (int i = 0; i < free; ++i) {
      const int row = states_ + free_[count(i)];
      solution[i] = -gradient_[count(row)];
      for (int j = 0; j < inputs_; ++j) solution[i] -= h(row, states_ + j) * change[count(j)];
    }
    const SquareMatrix quu{std::span(matrix_).first(count(free, free)), free};
    solve_factorised(quu, solution, 1);
    int inside = 0;
    for (int i = 0; i < free; ++i) {
      const int input = free_[count(i)];
      const double wanted = u[count(input)] + solution[i], nearest = bounds_.nearest(count(input), wanted);
      if (!std::isfinite(wanted)) return false;
      if (nearest == wanted) {
        free_[count(inside++)] = input;
      } else {
        change[count(input)] = nearest - u[count(input)];
      }
    }
    if (inside == free) break;
    free = inside;
  }
  for (int i = 0; i < free; ++i) change[count(free_[count(i)])] = solution[i];
  return true;
}

/// K = -Quu^-1 Qux for the free inputs, whose Quu is factorised in `matrix_`, and 0 for the others.
bool FeedbackGains::solve_gain(int k, int free) noexcept {
  const int n = states_;
  const SquareMatrix h{hessian_, n + inputs_}, quu{std::span(matrix_).first(count(free, free)), free};
  const std::span<double> gain = part(gains_, k, count(inputs_, n));
  for (int column = 0; column < n; ++column) {
    double* const rhs = vectors_.data();
    for (int i = 0; i < free; ++i) rhs[i] = -h(n + free_[count(i)], column);
    solve_factorised(quu, rhs, 1);
    for (int i = 0; i < free; ++i) gain[count(free_[count(i)], n) + count(column)] = rhs[i];
  }
  return all_finite(gain);
}

/// The cost to go from the states of step `k`, if the inputs change and follow the gain.
void FeedbackGains::end_step(int k) noexcept {
  const int n = states_, m = inputs_;
  const SquareMatrix h{hessian_, n + m};
  const std::span<const double> gain = this->gain(k), change = this->change(k);
  const auto at = [&](int input, int state) { return gain[count(input, n) + count(state)]; };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = 0.5 * (h(i, j) + h(j, i));
      for (int a = 0; a < m; ++a) {
        sum += at(a, i) * h(n + a, j) + h(n + a, i) * at(a, j);
        for (int b = 0; b < m; ++b) sum += at(a, i) * h(n + a, n + b) * at(b, j);
      }
      value_[count(i, n) + count(j)] = value_[count(j, n) + count(i)] = sum;
    }
    double sum = gradient_[count(i)];
    for (int a = 0; a < m; ++a) {
      double slope = h(n + a, i);
      for (int b = 0; b < m; ++b) slope += at(b, i) * h(n + b, n + a);
      sum += at(a, i) * gradient_[count(n + a)] + slope * change[count(a)];
    }
    value_gradient_[count(i)] = sum;
  }
  for (int a = 0; a < m; ++a) {
    linear_ += change[count(a)] * gradient_[count(n + a)];
    for (int b = 0; b < m; ++b) quadratic_ += change[count(a)] * h(n + a, n + b) * change[count(b)];
  }
}

/// The recursion from the end of the plan to its start, with or without changes of the inputs.
bool FeedbackGains::recurse(bool change_inputs, double damping) noexcept {
  linear_ = quadratic_ = 0;
  std::fill(gains_.begin(), gains_.end(), 0.0);
  std::fill(changes_.begin(), changes_.end(), 0.0);
  bool valid = all_finite(jacobians_) && all_finite(gradients_) && all_finite(hessians_);
  if (valid) {
    const Terminal end = terminal();
    make_semidefinite(end.hessian, states_);
    std::copy(end.hessian.begin(), end.hessian.end(), value_.begin());
    std::copy(end.gradient.begin(), end.gradient.end(), value_gradient_.begin());
  }
  for (int k = steps_ - 1; valid && k >= 0; --k) {
    begin_step(k);
    int free = choose_free_inputs(k);
    valid = all_finite(hessian_) && all_finite(gradient_);
    if (valid && free > 0) {
      valid = (change_inputs ? solve_change(k, free, damping) : factorise_free(free, damping)) &&
              solve_gain(k, free);
    }
    if (valid) end_step(k);
  }
  if (valid) return true;
  std::fill(gains_.begin(), gains_.end(), 0.0);
  std::fill(changes_.begin(), changes_.end(), 0.0);
  return false;
}

bool FeedbackGains::solve(double time_step) noexcept {
  time_step_ = time_step;
  return recurse(false, 0);
}

bool FeedbackGains::solve_step(double damping) noexcept {
  return recurse(true, damping);
}

void FeedbackGains::input_at(double t, std::span<const double> x, std::span<double> u) const noexcept {
  // Rounding of a multiple of the time step does not lead to the step before.
  const double position = std::isfinite(t) ? std::clamp(t / time_step_, 0.0, static_cast<double>(steps_)) : 0;
  const int k = std::min(static_cast<int>(position + 1e-9), steps_ - 1);
  const double share = position - k;
  const bool follow = std::isfinite(t) && all_finite(x);
  const double* const from = plan_states_.data() + count(k, states_);
  const double* const to = from + states_;
  const std::span<const double> gain = this->gain(k);
  for (int i = 0; i < inputs_; ++i) {
    double input = plan_inputs_[count(k, inputs_) + count(i)];
    for (int j = 0; follow && j < states_; ++j)
      input += gain[count(i, states_) + count(j)] * (x[count(j)] - (from[j] + share * (to[j] - from[j])));
    u[count(i)] = bounds_.nearest(count(i), input);
  }
}

}  // namespace slalom
