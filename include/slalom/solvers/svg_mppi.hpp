#pragma once

#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"

namespace slalom {

/// A controller that solves its problem with `svg_mppi`: Stein variational guided MPPI (Honda et al., ICRA
/// 2024).
template <class P>
class SvgMppi : public Controller<P> {
 public:
  /// Throws std::invalid_argument on options out of range.
  explicit SvgMppi(P problem, const SvgMppiOptions& options = {}, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

template <class P>
SvgMppi(P) -> SvgMppi<P>;
template <class P>
SvgMppi(P, SvgMppiOptions) -> SvgMppi<P>;
template <class P>
SvgMppi(P, SvgMppiOptions, std::shared_ptr<ThreadPool>) -> SvgMppi<P>;

}  // namespace slalom
