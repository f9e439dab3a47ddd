#pragma once

#include "slalom/gpu/solver.hpp"
#include "slalom/solvers/controller.hpp"

/// Controllers on a GPU, with the options and plans of `slalom::Mppi` and `slalom::SvgMppi`; docs/gpu.md.
namespace slalom::gpu {

/// A controller whose solver runs on a GPU. The code of `P` comes from `slalom_gpu_problem` in CMake. Of the
/// statistics of a plan, there are neither samples nor guides. If the device fails, plans repeat the last one
/// with the status `degenerate`, and `fault` says why. It can be moved, but not copied.
template <class P, class Options>
class GpuController : public Controller<P> {
 public:
  /// Throws std::invalid_argument on options out of range, options that a GPU lacks, and a problem that reads
  /// memory that it does not declare or whose costs differ on the GPU; DeviceError without a device for it.
  explicit GpuController(const P& problem, const Options& options = {})
      : Controller<P>(problem, std::make_unique<GpuSolver<P, Options>>(problem, options)) {}

  /// Copies the contents of the memory that the problem declares (`visit_memory`) again, for the next solve.
  /// Where the memory itself is another, a new controller is needed.
  void refresh() noexcept { const_cast<DeviceSolver&>(device_solver()).refresh(); }
  /// Why the device fails; empty if it does not.
  const std::string& fault() const noexcept { return device_solver().fault(); }

 private:
  const DeviceSolver& device_solver() const noexcept {
    return static_cast<const DeviceSolver&>(this->solver());
  }
};

/// `mppi` on a GPU.
template <class P>
using Mppi = GpuController<P, MppiOptions>;
/// `svg_mppi` on a GPU.
template <class P>
using SvgMppi = GpuController<P, SvgMppiOptions>;

}  // namespace slalom::gpu
