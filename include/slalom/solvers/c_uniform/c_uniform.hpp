#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "slalom/core/derivatives/linearize.hpp"
#include "slalom/solvers/c_uniform/c_uniform_law.hpp"
#include "slalom/solvers/controller.hpp"

namespace slalom {

/// Control sequences whose states spread evenly over what a problem can reach, as proposals of a solve. With
/// `nominal_from_proposals`, `mppi` first takes the best of them and then samples around it (CU-MPPI: O. G.
/// Poyrazoglu et al., "An Unsupervised C-Uniform Trajectory Sampler with Applications to Model Predictive
/// Path Integral Control", arXiv 2503.05819, 2025):
///
///     slalom::Mppi controller{Robot{}, {.horizon = 40, .input_min = ..., .nominal_from_proposals = true}};
///     slalom::CUniform law{controller, {0, 0, 0}, [](const auto& x) { return std::array{x.x, x.y, x.yaw}; },
///                          {{0.2}, {0.2}, {0.3, 2 * std::numbers::pi}}};   // cells: 0.2 m, 0.2 m, 0.3 rad
///     slalom::Proposals proposals{controller, 256};
///     slalom::RandomStream random{{.seed = 1}};
///     proposals.clear();                                                     // for each solve
///     while (proposals.size() < 256) proposals.add(law.draw(random));
///     const auto plan = controller.solve(x, {.elapsed = 0.1, .proposals = proposals});
///
/// The law is computed for one state, but a sequence is inputs alone. So it serves in every state from which
/// the same inputs make the same motion: for a vehicle, in every pose. Where the motion depends on the speed,
/// make laws for a few speeds and draw from that of the nearest. The cells know nothing of obstacles; the
/// costs of the solve do.
template <Problem P>
class CUniform {
  static constexpr int nx = detail::state_size<P>, nu = P::inputs;

 public:
  using State = detail::StateOf<P, double>;  ///< the problem's state in double
  using Inputs = Input<double, nu>;          ///< inputs of a step

  /// For the horizon and the bounds of a controller, from the state `start`. `locate(state)` returns the
  /// coordinates that are divided into cells, a std::array<double, N>, and `axes` has a cell size for each.
  /// Allocates, and takes the time of a few sweeps over all cells: up to some seconds. Throws
  /// std::invalid_argument as `CUniformLaw` does.
  template <class C, class Locate, std::size_t N>
  CUniform(const Controller<C>& controller, const State& start, Locate&& locate, const CellAxis (&axes)[N],
           const CUniformOptions& options = {})
      : CUniform(controller.problem(), controller.solver().horizon(), controller.bounds(), start, locate,
                 axes, options) {}
  /// For sequences of `horizon` steps within `bounds`; otherwise as above.
  template <class Locate, std::size_t N>
  CUniform(const P& problem, int horizon, const InputBounds& bounds, const State& start, Locate&& locate,
           const CellAxis (&axes)[N], const CUniformOptions& options = {})
      : law_(make(problem, horizon, bounds, start, locate, axes, options)),
        values_(static_cast<std::size_t>(horizon) * nu),
        inputs_(static_cast<std::size_t>(horizon)) {}

  /// Draws a control sequence, [horizon]; valid until the next call. Limits on rates are not applied. Does
  /// not allocate.
  std::span<const Inputs> draw(RandomStream& random) noexcept {
    law_.draw(random, values_);
    const double* value = values_.data();
    for (Inputs& u : inputs_)
      for (int i = 0; i < nu; ++i) u[i] = *value++;
    return inputs_;
  }

  /// Levels, cells and probabilities.
  const CUniformLaw& law() const noexcept { return law_; }

 private:
  /// The problem's dynamics, and the coordinates of its states.
  template <class Locate, std::size_t N>
  class System final : public CellDynamics {
   public:
    System(const P& problem, Locate& locate) noexcept : problem_(problem), locate_(locate) {}

    void step(int k, std::span<const double> x, std::span<const double> u, std::span<double> next) override {
      const State now = to_state(x);
      Inputs inputs;
      std::copy_n(u.begin(), nu, inputs.value);
      double values[nx];
      detail::scalars_of<P, double>(
          detail::step<P, double>(problem_, now, detail::look_up<P, double>(problem_, now), inputs, k),
          values);
      std::copy_n(values, nx, next.begin());
    }
    void locate(std::span<const double> x, std::span<double> coordinates) override {
      const std::array<double, N> found = locate_(to_state(x));
      std::copy(found.begin(), found.end(), coordinates.begin());
    }

   private:
    static State to_state(std::span<const double> x) {
      double values[nx];
      std::copy_n(x.begin(), nx, values);
      return detail::state_of<P, double>(values);
    }

    const P& problem_;
    Locate& locate_;
  };

  template <class Locate, std::size_t N>
  static CUniformLaw make(const P& problem, int horizon, const InputBounds& bounds, const State& start,
                          Locate& locate, const CellAxis (&axes)[N], const CUniformOptions& options) {
    System<Locate, N> system(problem, locate);
    double values[nx];
    detail::scalars_of<P, double>(start, values);
    return CUniformLaw(system, values, axes, horizon, bounds, options);
  }

  CUniformLaw law_;
  std::vector<double> values_;  ///< [step][input]
  std::vector<Inputs> inputs_;
};

/// The law of the problem of a controller.
template <class C, class Locate, std::size_t N>
CUniform(const Controller<C>&, const typename Controller<C>::State&, Locate&&, const CellAxis (&)[N],
         CUniformOptions = {})
    -> CUniform<std::remove_cvref_t<decltype(std::declval<const Controller<C>&>().problem())>>;

}  // namespace slalom
