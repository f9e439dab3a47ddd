#pragma once

#include "slalom/gpu/solver.hpp"
#include "slalom/solvers/controller.hpp"

/// Controllers that solve on a GPU, with the options and plans of `slalom::Mppi` and `slalom::SvgMppi`;
/// docs/gpu.md.
namespace slalom::gpu {

/// A controller whose solver runs on a GPU. The code of `P` comes from `slalom_gpu_problem` in CMake. Of the
/// statistics of a plan, there are neither samples nor guides. If the device fails, plans repeat the last one
/// with the status `degenerate`, and `fault` says why.
template <class P, class Options>
class GpuController : public Controller<P> {
 public:
  /// Throws std::invalid_argument on options out of range, options that a GPU lacks, and a problem that reads
  /// memory that it does not declare or whose costs differ on the GPU; DeviceError without a device that can
  /// run it.
  explicit GpuController(const P& problem, const Options& options = {})
      : Controller<P>(problem, std::make_unique<GpuSolver<P, Options>>(within_bounds(options, problem))) {}

  /// Copies the contents of the memory that the problem declares (`visit_memory`) again, for the next solve.
  /// Where the memory itself is another, a new controller is needed.
  void refresh() noexcept { gpu_solver().refresh(); }
  /// Why the device fails; empty if it does not.
  const std::string& fault() const noexcept { return gpu_solver().session().fault(); }
  /// The solver.
  GpuSolver<P, Options>& gpu_solver() const noexcept {
    return const_cast<GpuSolver<P, Options>&>(static_cast<const GpuSolver<P, Options>&>(this->solver()));
  }

 private:
  /// The options with their bounds narrowed to the problem's.
  static Options within_bounds(Options options, const P& problem) {
    PerInput &low = options.input_min, &high = options.input_max;
    if (!low.fits(P::inputs) || !high.fits(P::inputs)) return options;  // refused by the solver
    InputBounds bounds = slalom::detail::stated_bounds(problem);
    for (int i = 0; i < P::inputs; ++i) {
      const auto at = static_cast<std::size_t>(i);
      bounds.low[at] = std::max(bounds.low[at], low[i]), bounds.high[at] = std::min(bounds.high[at], high[i]);
    }
    low = bounds.low, high = bounds.high;
    return options;
  }
};

/// `mppi` on a GPU.
template <class P>
struct Mppi : GpuController<P, MppiOptions> {
  using GpuController<P, MppiOptions>::GpuController;
};
/// Takes the type of the problem from the argument.
template <class P>
Mppi(P, MppiOptions = {}) -> Mppi<P>;

/// `svg_mppi` on a GPU.
template <class P>
struct SvgMppi : GpuController<P, SvgMppiOptions> {
  using GpuController<P, SvgMppiOptions>::GpuController;
};
/// Takes the type of the problem from the argument.
template <class P>
SvgMppi(P, SvgMppiOptions = {}) -> SvgMppi<P>;

}  // namespace slalom::gpu
