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

/// Solves its problem with `mppi`: model predictive path integral control (Williams et al., "Information-
/// Theoretic Model Predictive Control", IEEE T-RO 2018).
template <class P>
struct Mppi : Controller<P> {
  /// Throws std::invalid_argument on options out of range.
  explicit Mppi(P problem, const MppiOptions& options = {}, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

/// Solves its problem with `svg_mppi`: Stein variational guided MPPI (Honda et al., ICRA 2024).
template <class P>
struct SvgMppi : Controller<P> {
  /// Throws std::invalid_argument on options out of range.
  explicit SvgMppi(P problem, const SvgMppiOptions& options = {}, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

/// Solves its problem with `reverse_mppi`: mirror descent on the reverse KL divergence with sample rejection
/// (Kobayashi and Fukumoto 2022).
template <class P>
struct ReverseMppi : Controller<P> {
  /// Throws std::invalid_argument on options out of range.
  explicit ReverseMppi(P problem, const ReverseMppiOptions& options = {},
                       std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

/// Solves its problem with `sv_mpc`: Stein variational MPC (Lambert et al., CoRL 2020).
template <class P>
struct SvMpc : Controller<P> {
  /// Throws std::invalid_argument on options out of range.
  explicit SvMpc(P problem, const SvMpcOptions& options = {}, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

/// Solves its problem with `cem`: the cross-entropy method.
template <class P>
struct Cem : Controller<P> {
  /// Throws std::invalid_argument on options out of range.
  explicit Cem(P problem, const CemOptions& options = {}, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

/// Solves its problem with `icem`: the improved cross-entropy method.
template <class P>
struct Icem : Controller<P> {
  /// Throws std::invalid_argument on options out of range.
  explicit Icem(P problem, const IcemOptions& options = {}, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

/// Solves its problem with `dial_mpc`: several updates of MPPI with annealed noise.
template <class P>
struct DialMpc : Controller<P> {
  /// Throws std::invalid_argument on options out of range.
  explicit DialMpc(P problem, const DialMpcOptions& options = {}, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

}  // namespace slalom
