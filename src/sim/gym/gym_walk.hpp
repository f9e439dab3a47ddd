#pragma once

#include "sim/gym/double_pack.hpp"
#include "sim/lidar/scan.hpp"
#include "slalom/core/dispatch.hpp"

namespace slalom::sim::detail {

/// The kernel of f1tenth_gym's walk through its distance field, one beam per lane.
struct GymWalk {
  /// The distance that f1tenth_gym looks up at (x, y).
  template <class D>
  SLALOM_INLINE_CALLS static D look_up(const GymWalkTask& task, const D& x, const D& y) {
    const D dx = x - D(task.origin_x), dy = y - D(task.origin_y), zero(0.0);
    const D gx = dx * D(task.origin_cosine) + dy * D(task.origin_sine),
            gy = -dx * D(task.origin_sine) + dy * D(task.origin_cosine);
    const auto inside = (gx >= zero) & (gy >= zero) & (gx < D(task.width * task.resolution)) &
                        (gy < D(task.height * task.resolution));
    const auto column = truncate(select(inside, gx, zero) / D(task.resolution)),
               row = truncate(select(inside, gy, zero) / D(task.resolution));
    // Outside the map it reads the last cell.
    return select(inside, D::gather(task.distance, row * task.width + column),
                  D(task.distance[task.width * task.height - 1]));
  }

  /// Four packs at a time, so that the look-ups of one hide behind those of the others.
  template <class Target>
  SLALOM_KERNEL static void run(const GymWalkTask& given) {
    using D = simd::DoublePack<Target>;
    constexpr int at_once = 4;
    const D close_enough(1e-4);  // m, to a wall
    const GymWalkTask task = given;
    const D most(task.most);
    for (int first = 0; first < scan_padding; first += at_once * D::lanes) {
      D x[at_once], y[at_once], cosine[at_once], sine[at_once], step[at_once], total[at_once];
      for (int k = 0; k < at_once; ++k) {
        cosine[k] = D::load(task.cosines + first + k * D::lanes);
        sine[k] = D::load(task.sines + first + k * D::lanes);
        x[k] = D(task.x);
        y[k] = D(task.y);
        total[k] = step[k] = look_up(task, x[k], y[k]);
      }
      for (bool again = true; again;) {
        again = false;
        for (int k = 0; k < at_once; ++k) {
          const auto goes_on = (step[k] > close_enough) & (total[k] <= most);
          x[k] = select(goes_on, x[k] + step[k] * cosine[k], x[k]);
          y[k] = select(goes_on, y[k] + step[k] * sine[k], y[k]);
          const D next = look_up(task, x[k], y[k]);
          step[k] = select(goes_on, next, step[k]);
          total[k] = select(goes_on, total[k] + next, total[k]);
          again |= any(goes_on);
        }
      }
      for (int k = 0; k < at_once; ++k)
        select(total[k] > most, most, total[k]).store(task.ranges + first + k * D::lanes);
    }
  }
};

}  // namespace slalom::sim::detail
