#pragma once

#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/icem_options.hpp"

namespace slalom {

/// A controller that solves its problem with `icem`: the improved cross-entropy method.
template <class P>
class Icem : public Controller<P> {
 public:
  /// Throws std::invalid_argument on options out of range.
  explicit Icem(P problem, const IcemOptions& options = {}, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

template <class P>
Icem(P) -> Icem<P>;
template <class P>
Icem(P, IcemOptions) -> Icem<P>;
template <class P>
Icem(P, IcemOptions, std::shared_ptr<ThreadPool>) -> Icem<P>;

}  // namespace slalom
