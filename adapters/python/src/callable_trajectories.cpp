#include <algorithm>

#include "callable_problem.hpp"

namespace slalom::python {

/// Rolls all sequences out together, since a call of a function takes as long as what it computes for all.
/// Throws py::value_error if a cost has a term that is not one of `terms`.
Trajectories CallableProblem::roll_out(std::span<const double> state, std::span<const float> sequences,
                                       int steps, std::span<const std::string> names) {
  if (!parts_.rollout.is_none()) return AnyProblem::roll_out(state, sequences, steps, names);
  const auto nx = static_cast<std::size_t>(parts_.states), nu = static_cast<std::size_t>(parts_.inputs);
  const std::size_t points = static_cast<std::size_t>(steps) + 1;
  const std::size_t count = sequences.size() / (static_cast<std::size_t>(steps) * nu);
  const auto rows = static_cast<py::ssize_t>(count);
  const std::size_t terms = names.size();
  std::vector<double> held(sequences.begin(), sequences.end());
  const std::vector<double> before(previous_.begin(), previous_.end());
  const std::size_t size = (points - 1) * nu;
  for (std::size_t s = 0; s < count; ++s) hold_rates(before, std::span(held).subspan(s * size, size));
  Trajectories all{std::vector<double>(count * points * nx), std::vector<double>(count * points * terms),
                   std::vector<int>(count, -1)};
  py::array_t<double> x({rows, static_cast<py::ssize_t>(nx)}), u({rows, static_cast<py::ssize_t>(nu)});
  for (std::size_t s = 0; s < count; ++s) std::copy(state.begin(), state.end(), x.mutable_data() + s * nx);
  std::vector<std::uint8_t> collided(count);
  std::vector<double> values(count);
  for (std::size_t k = 0; k < points; ++k) {
    const Numbers now(x);
    for (std::size_t s = 0; s < count; ++s) {
      std::copy_n(now.data() + s * nx, nx, all.states.data() + (s * points + k) * nx);
      if (k < points - 1) std::copy_n(&held[s * size + k * nu], nu, u.mutable_data() + s * nu);
    }
    const bool is_last = k + 1 == points;
    if (is_last && parts_.terminal_cost.is_none()) break;
    const char* const what = is_last ? "terminal_cost" : "cost";
    const py::object cost = is_last ? terminal_cost(x) : stage_cost(x, u, static_cast<int>(k));
    visit_terms(what, cost, rows, collided.data(), [&](const std::string& name, const py::array& result) {
      const auto term = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
      if (term == terms)
        throw py::value_error(std::string("Problem.") + what + ": the term '" + name +
                              "' is not among those of a prediction from the start; a cost must always "
                              "return the same terms, if need be with zeros");
      std::fill(values.begin(), values.end(), 0.0);
      add_column(result, 0, rows, values.data());
      for (std::size_t s = 0; s < count; ++s) all.costs[(s * points + k) * terms + term] += values[s];
    });
    for (std::size_t s = 0; s < count; ++s)
      if (collided[s] && all.collisions[s] < 0) all.collisions[s] = static_cast<int>(k);
    if (!is_last) x = next(x, u, static_cast<int>(k));
  }
  return all;
}

}  // namespace slalom::python
