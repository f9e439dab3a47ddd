#include "slalom/solvers/feedback_gains.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "solvers/feedback/symmetric_matrix.hpp"

namespace slalom {
namespace {

using detail::SquareMatrix;

std::size_t count(int a, int b = 1, int c = 1) {
  return static_cast<std::size_t>(a) * static_cast<std::size_t>(b) * static_cast<std::size_t>(c);
}

std::span<double> part(std::vector<double>& all, int index, std::size_t size) {
  return std::span(all).subspan(static_cast<std::size_t>(index) * size, size);
}

bool all_finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
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
  const int all = states + inputs;
  plan_states_.resize(count(steps + 1, states));
  plan_inputs_.resize(count(steps, inputs));
  for (std::size_t i = 0; i < plan_inputs_.size(); ++i)
    plan_inputs_[i] = bounds.nearest(i % count(inputs), 0);
  jacobians_.resize(count(steps, states, all));
  gradients_.resize(count(steps, all) + count(states));
  hessians_.resize(count(steps, all, all) + count(states, states));
  gains_.resize(count(steps, inputs, states));
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

/// K = -Quu^-1 Qux for the free inputs, 0 for the others.
bool FeedbackGains::solve_gain(int k, int free) noexcept {
  const int n = states_, all = states_ + inputs_;
  const std::span<double> gain = part(gains_, k, count(inputs_, n));
  std::fill(gain.begin(), gain.end(), 0.0);
  const SquareMatrix h{hessian_, all}, quu{std::span(matrix_).first(count(free, free)), free};
  double largest = 0;
  for (int i = 0; i < free; ++i) {
    largest = std::max(largest, h(n + free_[count(i)], n + free_[count(i)]));
    for (int j = 0; j < free; ++j) quu(i, j) = h(n + free_[count(i)], n + free_[count(j)]);
  }
  if (!(largest > 0)) return largest == 0;  // the cost does not depend on the inputs
  for (int i = 0; i < free; ++i) quu(i, i) += ridge * largest;
  if (!factorise(quu)) return false;
  for (int column = 0; column < n; ++column) {
    double* const rhs = vectors_.data();
    for (int i = 0; i < free; ++i) rhs[i] = -h(n + free_[count(i)], column);
    solve_factorised(quu, rhs, 1);
    for (int i = 0; i < free; ++i) gain[count(free_[count(i)], n) + count(column)] = rhs[i];
  }
  return all_finite(gain);
}

/// The cost to go from the states of step `k`, if the inputs follow the gain.
void FeedbackGains::end_step(int k) noexcept {
  const int n = states_, m = inputs_;
  const SquareMatrix h{hessian_, n + m};
  const std::span<const double> gain = this->gain(k);
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
    for (int a = 0; a < m; ++a) sum += at(a, i) * gradient_[count(n + a)];
    value_gradient_[count(i)] = sum;
  }
}

bool FeedbackGains::solve(double time_step) noexcept {
  time_step_ = time_step;
  bool valid = all_finite(jacobians_) && all_finite(gradients_) && all_finite(hessians_);
  if (valid) {
    const Terminal end = terminal();
    make_semidefinite(end.hessian, states_);
    std::copy(end.hessian.begin(), end.hessian.end(), value_.begin());
    std::copy(end.gradient.begin(), end.gradient.end(), value_gradient_.begin());
  }
  for (int k = steps_ - 1; valid && k >= 0; --k) {
    begin_step(k);
    valid = all_finite(hessian_) && all_finite(gradient_) && solve_gain(k, choose_free_inputs(k));
    if (valid) end_step(k);
  }
  if (!valid) std::fill(gains_.begin(), gains_.end(), 0.0);
  return valid;
}

void FeedbackGains::input_at(double t, std::span<const double> x, std::span<double> u) const noexcept {
  // What rounding takes from a multiple of the time step does not lead to the step before.
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
