#include "python_derivatives.hpp"
#include "slalom/solvers/c_uniform/c_uniform_law.hpp"

namespace slalom::python {
namespace {

/// The dynamics of a problem in Python, with the coordinates that a callable returns for a state.
class PythonCells final : public CellDynamics {
 public:
  /// `coordinates` is None where the state itself has the coordinates.
  PythonCells(AnyProblem& problem, py::object coordinates)
      : problem_(problem), coordinates_(std::move(coordinates)) {}

  void step(int, std::span<const double> x, std::span<const double> u, std::span<double> next) override {
    const std::vector<double> following = problem_.step(x, u);
    std::copy(following.begin(), following.end(), next.begin());
  }
  void locate(std::span<const double> x, std::span<double> coordinates) override {
    std::vector<double> found(x.begin(), x.end());
    if (!coordinates_.is_none()) {
      const auto size = static_cast<py::ssize_t>(x.size());
      found = coordinates_(py::array_t<double>(size, x.data())).cast<std::vector<double>>();
    }
    found = checked(std::move(found), static_cast<int>(coordinates.size()), "coordinates");
    std::copy(found.begin(), found.end(), coordinates.begin());
  }

 private:
  AnyProblem& problem_;
  py::object coordinates_;
};

/// A C-Uniform law with the random numbers for its sequences.
class CUniform {
 public:
  CUniform(Controller& controller, std::vector<double> start, const std::vector<double>& sizes,
           std::vector<double> periods, py::object coordinates, const CUniformOptions& options,
           std::uint64_t seed)
      : law_(make(controller, std::move(start), sizes, std::move(periods), std::move(coordinates), options)),
        random_({.seed = seed}) {}

  py::array_t<double> draw(int sequences) {
    if (sequences < 0)
      throw std::invalid_argument("sequences: " + std::to_string(sequences) + " must be at least 0");
    py::array_t<double> drawn(
        {py::ssize_t{sequences}, py::ssize_t{law_.horizon()}, py::ssize_t{law_.inputs()}});
    const auto size = static_cast<std::size_t>(law_.horizon() * law_.inputs());
    for (std::size_t i = 0; i < static_cast<std::size_t>(sequences); ++i)
      law_.draw(random_, {drawn.mutable_data() + i * size, size});
    return drawn;
  }
  void reset(std::uint64_t seed) { random_ = RandomStream({.seed = seed}); }

  const CUniformLaw& law() const { return law_; }

 private:
  static CUniformLaw make(Controller& controller, std::vector<double> start, const std::vector<double>& sizes,
                          std::vector<double> periods, py::object coordinates,
                          const CUniformOptions& options) {
    AnyProblem& problem = controller.problem();
    const auto axes = static_cast<int>(sizes.size());
    start = checked(std::move(start), problem.states(), "start");
    periods =
        periods.empty() ? std::vector<double>(sizes.size()) : checked(std::move(periods), axes, "periods");
    std::vector<CellAxis> cells;
    for (std::size_t i = 0; i < sizes.size(); ++i) cells.push_back({sizes[i], periods[i]});
    PythonCells system(problem, std::move(coordinates));
    return CUniformLaw(system, start, cells, controller.solver().horizon(), controller.bounds(), options);
  }

  CUniformLaw law_;
  RandomStream random_;
};

}  // namespace

void bind_c_uniform(py::module_& module) {
  constexpr auto defaults = [] { return CUniformOptions{}; };
  py::class_<CUniform>(
      module, "CUniform",
      "Control sequences whose states spread evenly over what a problem can reach, as proposals of a solve. "
      "With "
      "`nominal_from_proposals`, `Mppi` samples around the best of them (CU-MPPI).\n\n"
      "controller: its problem, horizon and bounds are used\n"
      "start: the state from which sequences are made; they serve in every state from which the same inputs "
      "make "
      "the same motion\n"
      "sizes: size of a cell for each coordinate\n"
      "periods: after which a coordinate repeats, such as 2 pi of a heading, for each coordinate; 0: never\n"
      "coordinates: callable, state -> coordinates that are divided into cells; by default the state itself\n"
      "input_steps: steps for which an input is held, from one level to the next\n"
      "input_values: number of values of an input, evenly spaced between its bounds; one number, or one for "
      "each "
      "input\n"
      "cells: most cells of all levels together\n"
      "sweeps: most sweeps over the cells of a level; more make the distribution more uniform\n"
      "seed: seed of the random numbers")
      .def(py::init([](const py::object& controller, std::vector<double> start,
                       const std::vector<double>& sizes, std::vector<double> periods, py::object coordinates,
                       int input_steps, const py::object& input_values, int cells, int sweeps,
                       std::uint64_t seed) {
             if (!py::isinstance<Controller>(controller))
               throw py::type_error("CUniform: controller must be a slalom.Controller");
             CUniformOptions options;
             options.input_steps = input_steps;
             options.cells = cells;
             options.sweeps = sweeps;
             set_field(options.input_values, "CUniform.input_values", input_values);
             return std::make_unique<CUniform>(controller.cast<Controller&>(), std::move(start), sizes,
                                               std::move(periods), std::move(coordinates), options, seed);
           }),
           py::arg("controller"), py::arg("start"), py::arg("sizes"),
           py::arg("periods") = std::vector<double>(), py::arg("coordinates") = py::none(),
           py::arg("input_steps") = defaults().input_steps,
           py::arg("input_values") = defaults().input_values[0], py::arg("cells") = defaults().cells,
           py::arg("sweeps") = defaults().sweeps, py::arg("seed") = 0)
      .def("draw", &CUniform::draw, py::arg("sequences"),
           "Draws control sequences, float64 [sequences, horizon, inputs], for `proposals` of a solve.")
      .def("reset", &CUniform::reset, py::arg("seed") = 0, "Starts the random numbers from `seed`.")
      .def_property_readonly(
          "levels", [](const CUniform& c) { return c.law().levels(); },
          "levels after the start, which is the number of inputs of a sequence")
      .def(
          "masses",
          [](const CUniform& c, int level) {
            if (level < 0 || level > c.law().levels())
              throw py::index_error("level: " + std::to_string(level) + " must be in [0, " +
                                    std::to_string(c.law().levels()) + "]");
            const std::span<const double> masses = c.law().masses(level);
            return py::array_t<double>(static_cast<py::ssize_t>(masses.size()), masses.data());
          },
          py::arg("level"), "The planned probability of each cell of a level, float64 [cells].");
}

}  // namespace slalom::python
