#pragma once

#include <algorithm>
#include <span>

#include "slalom/core/thread_pool.hpp"
#include "slalom/solvers/controller.hpp"

namespace slalom {

/// Solves from many states at once, each with a controller and so a warm start of its own, on the threads of
/// `pool`: for a swarm, for training, for variants of a plan. `controllers` has one for each of `states`;
/// copies of one controller draw the same noise unless each is `reset` with a seed of its own. All get the
/// same `request`. Calls `use(i, plan)` with each plan, on the thread that solved it. The plans do not depend
/// on the number of threads. Controllers with one thread each (`.threads = 1`) are fastest. Does not allocate
/// or throw.
///
///     std::vector<slalom::Mppi<Cart>> fleet(100, slalom::Mppi{Cart{}, {.horizon = 20}});
///     slalom::solve_batch(std::span(fleet), states, {.elapsed = 0.1}, pool,
///                         [&](int i, const auto& plan) { inputs[i] = plan.inputs[0]; });
template <class C, class Use>
void solve_batch(std::span<C> controllers, std::span<const typename C::State> states,
                 const SolveRequest& request, ThreadPool& pool, Use&& use) noexcept {
  pool.run(static_cast<int>(std::min(controllers.size(), states.size())), [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    use(i, controllers[at].solve(states[at], request));
  });
}

}  // namespace slalom
