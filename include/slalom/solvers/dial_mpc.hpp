#pragma once

#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/dial_mpc_options.hpp"

namespace slalom {

/// A controller that solves its problem with `dial_mpc`: several updates of MPPI with annealed noise.
template <class P>
class DialMpc : public Controller<P> {
 public:
  /// Throws std::invalid_argument on options out of range.
  explicit DialMpc(P problem, const DialMpcOptions& options = {}, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

template <class P>
DialMpc(P) -> DialMpc<P>;
template <class P>
DialMpc(P, DialMpcOptions) -> DialMpc<P>;
template <class P>
DialMpc(P, DialMpcOptions, std::shared_ptr<ThreadPool>) -> DialMpc<P>;

}  // namespace slalom
