#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "callable_problem.hpp"

/// Derivatives of callables by central differences, all in one call of each.
namespace slalom::python {
namespace {

/// Steps of the differences, relative to the larger of 1 and the scalar: the cube root of the rounding error
/// for first derivatives, its fourth root for second ones.
constexpr double first_step = 6e-6, second_step = 1.2e-4;

/// The points at which differences around `z` need the functions: z itself, z -+ the first step along each
/// axis, z -+ the second step along each axis, and for each pair of axes the four corners.
class Differences {
 public:
  explicit Differences(std::vector<double> z) : z_(std::move(z)), n_(z_.size()) {
    points_.push_back(z_);
    for (const double relative : {first_step, second_step})
      for (std::size_t i = 0; i < n_; ++i)
        for (const double sign : {-1.0, 1.0}) add(i, sign * step(i, relative), i, 0);
    for (std::size_t i = 0; i < n_; ++i)
      for (std::size_t j = 0; j < i; ++j)
        for (const double a : {-1.0, 1.0})
          for (const double b : {-1.0, 1.0}) add(i, a * step(i, second_step), j, b * step(j, second_step));
  }

  /// The scalars `first` ... `first + count - 1` of all points as columns.
  py::array columns(int first, int count) const {
    const auto rows = static_cast<py::ssize_t>(points_.size());
    py::array_t<double, py::array::f_style> all({rows, py::ssize_t{count}});
    for (py::ssize_t row = 0; row < rows; ++row)
      for (int c = 0; c < count; ++c)
        all.mutable_at(row, c) = points_[static_cast<std::size_t>(row)][static_cast<std::size_t>(first + c)];
    return all;
  }

  /// The derivative along axis `i` of a function with these values at the points; `kink` is set if the
  /// differences to both sides disagree.
  template <class Values>
  double slope(const Values& f, std::size_t i, bool& kink) const {
    const double low = f(1 + 2 * i), high = f(2 + 2 * i), h = step(i, first_step);
    const double slope = (high - low) / (2 * h);
    kink = kink || !(std::abs((high - f(0)) - (f(0) - low)) <= 1e-3 * h * (1 + std::abs(slope)));
    return slope;
  }

  /// The second derivative along axes `i` and `j`.
  template <class Values>
  double curvature(const Values& f, std::size_t i, std::size_t j) const {
    if (i < j) std::swap(i, j);
    const double h = step(i, second_step) * step(j, second_step);
    if (i == j) {
      const std::size_t at = 1 + 2 * n_ + 2 * i;
      return (f(at) + f(at + 1) - 2 * f(0)) / h;
    }
    const std::size_t at = 1 + 4 * n_ + 4 * (i * (i - 1) / 2 + j);
    return (f(at) - f(at + 1) - f(at + 2) + f(at + 3)) / (4 * h);
  }

 private:
  double step(std::size_t axis, double relative) const {
    return relative * std::max(1.0, std::abs(z_[axis]));
  }
  void add(std::size_t i, double di, std::size_t j, double dj) {
    points_.push_back(z_);
    points_.back()[i] += di;
    points_.back()[j] += dj;
  }

  std::vector<double> z_;
  std::size_t n_;
  std::vector<std::vector<double>> points_;
};

/// Fills cost, gradient and Hessian from the values of the cost at all points.
void differentiate_cost(const Differences& at, std::size_t n, const std::vector<double>& cost,
                        Derivatives& d) {
  const auto f = [&](std::size_t point) { return cost[point]; };
  d.cost = cost[0];
  for (std::size_t i = 0; i < n; ++i) {
    d.gradient.push_back(at.slope(f, i, d.kink));
    for (std::size_t j = 0; j < n; ++j) d.hessian.push_back(at.curvature(f, i, j));
  }
}

/// Throws unless the result of a callable is in double.
void require_double(const char* what, const py::object& result) {
  if (py::isinstance<py::tuple>(result) && py::len(result) == 2)
    return require_double(what, py::reinterpret_borrow<py::tuple>(result)[0]);
  if (py::isinstance<py::dict>(result)) {
    for (const auto& [name, term] : py::reinterpret_borrow<py::dict>(result))
      require_double(what, py::reinterpret_borrow<py::object>(term));
    return;
  }
  if (py::isinstance<py::array_t<float>>(result))
    throw py::type_error(std::string("Problem.") + what +
                         ": returned float32 for float64 arguments; derivatives are differences, which "
                         "need float64: do not convert with astype or float32 arrays");
}

}  // namespace

std::vector<double> CallableProblem::values_at(const py::array& x, const py::array& u,
                                               std::vector<double>* next_states) const {
  const py::ssize_t count = x.shape(0);
  std::vector<double> costs(static_cast<std::size_t>(count));
  std::vector<std::uint8_t> collided(costs.size());
  const py::object cost = cost_(x, u);
  require_double("cost", cost);
  add_cost("cost", cost, count, costs.data(), collided.data());
  if (next_states) {
    const py::array states = next(x, u);
    require_double("dynamics", states);
    const auto rows = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(states);
    next_states->assign(rows.data(), rows.data() + rows.size());
  }
  return costs;
}

std::vector<double> CallableProblem::terminal_values_at(const py::array& x) const {
  const py::ssize_t count = x.shape(0);
  std::vector<double> costs(static_cast<std::size_t>(count));
  std::vector<std::uint8_t> collided(costs.size());
  if (terminal_cost_.is_none()) return costs;
  const py::object cost = terminal_cost_(x);
  require_double("terminal_cost", cost);
  add_cost("terminal_cost", cost, count, costs.data(), collided.data());
  return costs;
}

Derivatives CallableProblem::derivatives(std::span<const double> state, std::span<const double> input) {
  std::vector<double> z(state.begin(), state.end());
  z.insert(z.end(), input.begin(), input.end());
  const std::size_t nx = state.size(), n = z.size();
  const Differences at(std::move(z));
  std::vector<double> states;
  const auto costs = values_at(at.columns(0, states_), at.columns(states_, inputs_), &states);
  Derivatives d;
  d.next.assign(states.begin(), states.begin() + static_cast<std::ptrdiff_t>(nx));
  for (std::size_t row = 0; row < nx; ++row) {
    const auto f = [&](std::size_t point) { return states[point * nx + row]; };
    for (std::size_t i = 0; i < n; ++i)
      (i < nx ? d.state_jacobian : d.input_jacobian).push_back(at.slope(f, i, d.kink));
  }
  differentiate_cost(at, n, costs, d);
  return d;
}

Derivatives CallableProblem::terminal_derivatives(std::span<const double> state) {
  const Differences at(std::vector<double>(state.begin(), state.end()));
  Derivatives d;
  differentiate_cost(at, state.size(), terminal_values_at(at.columns(0, states_)), d);
  return d;
}

}  // namespace slalom::python
