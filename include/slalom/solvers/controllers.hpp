#pragma once

#include "slalom/solvers/cem_options.hpp"
#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/dial_mpc_options.hpp"
#include "slalom/solvers/icem_options.hpp"
#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/reverse_mppi_options.hpp"
#include "slalom/solvers/sv_mpc_options.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"

/// Controllers with a fixed method.
namespace slalom {

namespace detail {

/// A controller with the method of these options.
template <class P, class Options>
class ControllerOf : public Controller<P> {
 public:
  /// Throws std::invalid_argument on options out of range.
  explicit ControllerOf(P problem, const Options& options = {}, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

}  // namespace detail

/// Solves its problem with `mppi`: model predictive path integral control (Williams et al., "Information-
/// Theoretic Model Predictive Control", IEEE T-RO 2018).
template <class P>
struct Mppi : detail::ControllerOf<P, MppiOptions> {
  using detail::ControllerOf<P, MppiOptions>::ControllerOf;
};
/// Takes the type of the problem from the argument.
template <class P>
Mppi(P, MppiOptions = {}, std::shared_ptr<ThreadPool> = nullptr) -> Mppi<P>;

/// Solves its problem with `svg_mppi`: Stein variational guided MPPI (Honda et al., ICRA 2024).
template <class P>
struct SvgMppi : detail::ControllerOf<P, SvgMppiOptions> {
  using detail::ControllerOf<P, SvgMppiOptions>::ControllerOf;
};
/// Takes the type of the problem from the argument.
template <class P>
SvgMppi(P, SvgMppiOptions = {}, std::shared_ptr<ThreadPool> = nullptr) -> SvgMppi<P>;

/// Solves its problem with `reverse_mppi`: mirror descent on the reverse KL divergence with sample rejection
/// (Kobayashi and Fukumoto 2022).
template <class P>
struct ReverseMppi : detail::ControllerOf<P, ReverseMppiOptions> {
  using detail::ControllerOf<P, ReverseMppiOptions>::ControllerOf;
};
/// Takes the type of the problem from the argument.
template <class P>
ReverseMppi(P, ReverseMppiOptions = {}, std::shared_ptr<ThreadPool> = nullptr) -> ReverseMppi<P>;

/// Solves its problem with `sv_mpc`: Stein variational MPC (Lambert et al., CoRL 2020).
template <class P>
struct SvMpc : detail::ControllerOf<P, SvMpcOptions> {
  using detail::ControllerOf<P, SvMpcOptions>::ControllerOf;
};
/// Takes the type of the problem from the argument.
template <class P>
SvMpc(P, SvMpcOptions = {}, std::shared_ptr<ThreadPool> = nullptr) -> SvMpc<P>;

/// Solves its problem with `cem`: the cross-entropy method.
template <class P>
struct Cem : detail::ControllerOf<P, CemOptions> {
  using detail::ControllerOf<P, CemOptions>::ControllerOf;
};
/// Takes the type of the problem from the argument.
template <class P>
Cem(P, CemOptions = {}, std::shared_ptr<ThreadPool> = nullptr) -> Cem<P>;

/// Solves its problem with `icem`: the improved cross-entropy method.
template <class P>
struct Icem : detail::ControllerOf<P, IcemOptions> {
  using detail::ControllerOf<P, IcemOptions>::ControllerOf;
};
/// Takes the type of the problem from the argument.
template <class P>
Icem(P, IcemOptions = {}, std::shared_ptr<ThreadPool> = nullptr) -> Icem<P>;

/// Solves its problem with `dial_mpc`: several updates of MPPI with annealed noise.
template <class P>
struct DialMpc : detail::ControllerOf<P, DialMpcOptions> {
  using detail::ControllerOf<P, DialMpcOptions>::ControllerOf;
};
/// Takes the type of the problem from the argument.
template <class P>
DialMpc(P, DialMpcOptions = {}, std::shared_ptr<ThreadPool> = nullptr) -> DialMpc<P>;

}  // namespace slalom
