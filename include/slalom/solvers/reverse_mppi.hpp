#pragma once

#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/reverse_mppi_options.hpp"

namespace slalom {

/// A controller that solves its problem with `reverse_mppi`: mirror descent on the reverse KL divergence with
/// sample rejection (Kobayashi and Fukumoto 2022).
template <class P>
class ReverseMppi : public Controller<P> {
 public:
  /// Throws std::invalid_argument on options out of range.
  explicit ReverseMppi(P problem, const ReverseMppiOptions& options = {},
                       std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller<P>(std::move(problem), options, std::move(pool)) {}
};

template <class P>
ReverseMppi(P) -> ReverseMppi<P>;
template <class P>
ReverseMppi(P, ReverseMppiOptions) -> ReverseMppi<P>;
template <class P>
ReverseMppi(P, ReverseMppiOptions, std::shared_ptr<ThreadPool>) -> ReverseMppi<P>;

}  // namespace slalom
