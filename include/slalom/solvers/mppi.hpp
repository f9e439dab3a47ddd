#pragma once

#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/mppi_options.hpp"

namespace slalom {

/// A controller that solves its problem with `mppi`: model predictive path integral control (Williams et al.,
/// "Information-Theoretic Model Predictive Control", IEEE T-RO 2018).
template <class P>
class Mppi : public Controller<P> {
 public:
  /// Throws std::invalid_argument on options out of range.
  explicit Mppi(P problem, const MppiOptions& options = {}, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

template <class P>
Mppi(P) -> Mppi<P>;
template <class P>
Mppi(P, MppiOptions) -> Mppi<P>;
template <class P>
Mppi(P, MppiOptions, std::shared_ptr<ThreadPool>) -> Mppi<P>;

}  // namespace slalom
