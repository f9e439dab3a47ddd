#pragma once

#include "slalom/solvers/cem_options.hpp"
#include "slalom/solvers/controller.hpp"

namespace slalom {

/// A controller that solves its problem with `cem`: the cross-entropy method.
template <class P>
class Cem : public Controller<P> {
 public:
  /// Throws std::invalid_argument on options out of range.
  explicit Cem(P problem, const CemOptions& options = {}, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

template <class P>
Cem(P) -> Cem<P>;
template <class P>
Cem(P, CemOptions) -> Cem<P>;
template <class P>
Cem(P, CemOptions, std::shared_ptr<ThreadPool>) -> Cem<P>;

}  // namespace slalom
