#include "slalom/solvers/ilqr.hpp"

#include <cmath>

#include "slalom/solvers/solver_base.hpp"

namespace slalom {
namespace {

/// Damping of a step after the first that failed, factor from one to the next, and the most.
constexpr double first_damping = 1e-3, damping_factor = 10, most_damping = 1e6;

/// The least part of the way to the solution of the linear-quadratic problem that is tried.
constexpr double least_part = 1.0 / 32;

/// The least part of the expected fall of the cost for which a step is taken.
constexpr double least_fall = 1e-4;

/// The values of one step.
std::span<double> row(std::vector<double>& all, int index, std::size_t size) {
  return std::span(all).subspan(static_cast<std::size_t>(index) * size, size);
}

}  // namespace

IterativeLqr::IterativeLqr(int states, int inputs, int steps, const InputBounds& bounds,
                           const IlqrOptions& options)
    : gains_(states, inputs, steps, bounds), bounds_(bounds), most_iterations_(options.iterations) {
  validate_options(options, "ilqr");
  inputs_.resize(static_cast<std::size_t>(steps) * static_cast<std::size_t>(inputs));
  states_.resize(static_cast<std::size_t>(steps + 1) * static_cast<std::size_t>(states));
  tried_inputs_ = inputs_;
  tried_states_ = states_;
  start_from({});
}

void IterativeLqr::start_from(std::span<const double> inputs) noexcept {
  const auto nu = static_cast<std::size_t>(gains_.inputs());
  inputs = inputs.first(inputs.size() / nu * nu);
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    const std::size_t held = inputs.empty() ? 0 : std::min(i, inputs.size() - nu + i % nu);
    inputs_[i] = bounds_.nearest(i % nu, inputs.empty() ? 0 : inputs[held]);
    if (!std::isfinite(inputs_[i])) inputs_[i] = bounds_.nearest(i % nu, 0);
  }
}

void IterativeLqr::shift(double steps) noexcept {
  if (!(steps > 0)) return;
  shift_sequence(inputs_.data(), gains_.steps(), gains_.inputs(), std::min(steps, 1e6), tried_inputs_.data());
  inputs_.swap(tried_inputs_);
}

std::span<const double> IterativeLqr::improve(DifferentiableProblem& problem, std::span<const double> x) {
  std::copy(x.begin(), x.end(), tried_states_.begin());
  iterations_ = 0;
  damping_ = 0;
  kink_ = false;
  cost_ = first_cost_ = try_inputs(problem, 0, false);
  take_inputs();
  while (iterations_ < most_iterations_ && std::isfinite(cost_) && lower_cost(problem)) ++iterations_;
  return inputs_;
}

/// The inputs `part` of the way to the solution of the linear-quadratic problem, and their states; with the
/// inputs as they are, unless they `follow` the gains. Returns their cost.
double IterativeLqr::try_inputs(DifferentiableProblem& problem, double part, bool follow) {
  const auto nx = static_cast<std::size_t>(gains_.states()), nu = static_cast<std::size_t>(gains_.inputs());
  for (int k = 0; k < gains_.steps(); ++k) {
    const std::span<const double> x = row(tried_states_, k, nx);
    const std::span<double> u = row(tried_inputs_, k, nu);
    const std::span<const double> before = row(inputs_, k, nu), planned = row(states_, k, nx);
    for (std::size_t i = 0; i < nu; ++i) {
      double value = before[i];
      if (follow) {
        value += part * gains_.change(k)[i];
        for (std::size_t j = 0; j < nx; ++j) value += gains_.gain(k)[i * nx + j] * (x[j] - planned[j]);
      }
      u[i] = bounds_.nearest(i, value);
    }
    problem.step(k, x, u, row(tried_states_, k + 1, nx));
  }
  return problem.cost(std::span(tried_states_).first(nx), tried_inputs_);
}

void IterativeLqr::take_inputs() noexcept {
  inputs_ = tried_inputs_;
  states_ = tried_states_;
}

/// One step. Returns false if none lowers the cost.
bool IterativeLqr::lower_cost(DifferentiableProblem& problem) {
  const auto nx = static_cast<std::size_t>(gains_.states()), nu = static_cast<std::size_t>(gains_.inputs());
  for (int k = 0; k < gains_.steps(); ++k) {
    const FeedbackGains::Step to = gains_.step(k);
    std::copy_n(row(states_, k, nx).begin(), nx, to.state.begin());
    std::copy_n(row(inputs_, k, nu).begin(), nu, to.inputs.begin());
  }
  std::copy_n(row(states_, gains_.steps(), nx).begin(), nx, gains_.terminal().state.begin());
  kink_ |= gains_.expand(problem);
  for (; damping_ <= most_damping; damping_ = std::max(damping_factor * damping_, first_damping)) {
    if (!gains_.solve_step(damping_)) return false;
    if (!(gains_.expected_change(1) < -1e-14 * (1 + std::abs(cost_)))) return false;
    for (double part = 1; part >= least_part; part *= 0.5) {
      const double cost = try_inputs(problem, part, true);
      if (!(cost_ - cost > -least_fall * gains_.expected_change(part))) continue;
      cost_ = cost;
      take_inputs();
      damping_ = damping_ > first_damping ? damping_ / damping_factor : 0;
      return true;
    }
  }
  return false;
}

}  // namespace slalom
