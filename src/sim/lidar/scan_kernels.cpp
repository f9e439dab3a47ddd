#include "sim/lidar/range_noise.hpp"
#include "sim/lidar/wall_scan.hpp"

namespace slalom::sim::detail {
namespace {

/// The kernel that shortens ranges to a body: ray against box by slabs (Kay & Kajiya, "Ray Tracing Complex
/// Scenes", 1986), or against a disc. One beam per lane.
struct CastBody {
  template <class F>
  SLALOM_INLINE static F to_disc(const CastTask& task, const F& dx, const F& dy) {
    const F x(task.x), y(task.y), radius(task.radius), zero(0.0f);
    const F along = -(x * dx + y * dy), across = x * dy - y * dx;
    const F under = radius * radius - across * across;
    const F half = sqrt(max(under, zero));
    const F near = along - half, far = along + half;
    return select((under < zero) | (far < zero), F(1e30f), select(near >= zero, near, far));
  }

  template <class F>
  SLALOM_INLINE static F to_box(const CastTask& task, const F& dx, const F& dy) {
    const F ix = inverse(dx, 1e-12f), iy = inverse(dy, 1e-12f);
    const F x0 = F(-task.half_length - task.x) * ix, x1 = F(task.half_length - task.x) * ix;
    const F y0 = F(-task.half_width - task.y) * iy, y1 = F(task.half_width - task.y) * iy;
    const F enter = max(min(x0, x1), min(y0, y1)), leave = min(max(x0, x1), max(y0, y1));
    return select((enter > leave) | (leave < F(0.0f)), F(1e30f), select(enter >= F(0.0f), enter, leave));
  }

  template <class Target>
  SLALOM_KERNEL static void run(const CastTask& task) {
    using F = Pack<simd::Unfused<Target>>;
    for (int first = task.first; first <= task.last; first += F::lanes) {
      // The last pack steps back where it would pass the window: it sees some beams twice.
      const int at =
          first + F::lanes - 1 > task.last && task.last >= F::lanes - 1 ? task.last - F::lanes + 1 : first;
      const F c = F::load(task.cosines + at), s = F::load(task.sines + at);
      const F dx = F(task.cosine) * c - F(task.sine) * s, dy = F(task.sine) * c + F(task.cosine) * s;
      const F distance = task.radius > 0 ? to_disc(task, dx, dy) : to_box(task, dx, dy);
      min(distance, F::load(task.ranges + at)).store(task.ranges + at);
    }
  }
};

}  // namespace

ScanKernels scan_kernels(simd::Target target) {
  return {simd::kernel<ScanWalls>(target), simd::kernel<CastBody>(target),
          simd::kernel<AddRangeNoise>(target)};
}

const ScanKernels& scan_kernels() {
  static const ScanKernels chosen = scan_kernels(simd::active_target());
  return chosen;
}

}  // namespace slalom::sim::detail
