#pragma once

#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/sv_mpc_options.hpp"

namespace slalom {

/// A controller that solves its problem with `sv_mpc`: Stein variational MPC (Lambert et al., CoRL 2020).
template <class P>
class SvMpc : public Controller<P> {
 public:
  /// Throws std::invalid_argument on options out of range.
  explicit SvMpc(P problem, const SvMpcOptions& options = {}, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

template <class P>
SvMpc(P) -> SvMpc<P>;
template <class P>
SvMpc(P, SvMpcOptions) -> SvMpc<P>;
template <class P>
SvMpc(P, SvMpcOptions, std::shared_ptr<ThreadPool>) -> SvMpc<P>;

}  // namespace slalom
