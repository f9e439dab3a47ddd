#pragma once

#include <utility>

#include "sim/lidar/scan.hpp"
#include "slalom/core/math.hpp"

/// Distances to walls, one beam per lane. No product is fused with a sum: all instruction sets give the same
/// bits.
namespace slalom::sim::detail {

/// A pack of rays on its way through the grid.
template <class F>
struct Rays {
  F t, c, s;  ///< way from the sensor, cells, and direction in the grid
  F inverse_c, inverse_s;
  F ahead_x, ahead_y;  ///< 1 where the next border lies on the larger side of a cell, else 0
  int first;           ///< beam or cone
};

template <class F>
SLALOM_INLINE void aim(const ScanTask& task, const float* cosines, const float* sines, Rays<F>& rays) {
  const F c = F::load(cosines), s = F::load(sines);
  rays.c = F(task.cosine) * c - F(task.sine) * s;
  rays.s = F(task.sine) * c + F(task.cosine) * s;
}

/// The cell at a position and its clearance.
template <class Target>
struct CellBelow {
  simd::IntPack<Target> column, row, clearance;
};

template <class Target>
SLALOM_INLINE_CALLS CellBelow<Target> look_up_cell(const ScanTask& task, const Pack<Target>& x,
                                                   const Pack<Target>& y) {
  CellBelow<Target> cell{truncate(x), truncate(y), {}};
  const simd::IntPack<Target> index = cell.row * task.stride + cell.column;
  simd::Operations<Target>::gather(task.clearance, index.v, cell.clearance.v);
  return cell;
}

/// One step of cones, as far as no beam of theirs can meet a wall; false if no cone moved.
template <class F>
SLALOM_INLINE_CALLS bool step_cones(const ScanTask& task, Rays<F>& rays) {
  const F scale(1.0f / 64), worth_a_step(1.0f);  // cells
  const auto cell = look_up_cell(task, F(task.x) + rays.t * rays.c, F(task.y) + rays.t * rays.s);
  const F step = to_float(cell.clearance) * scale - rays.t * F(task.cone_width);
  const auto goes_on = (step > worth_a_step) & (rays.t < F(task.most));
  rays.t = select(goes_on, rays.t + step, rays.t);
  return any(goes_on);
}

/// Fills `reach` for all cones, four packs at a time so that look-ups hide behind arithmetic.
template <class F>
SLALOM_INLINE_CALLS void walk_cones(const ScanTask& task, int begin, int count, float* reach) {
  constexpr int at_once = 4;
  for (int done = 0; done < count; done += at_once * F::lanes) {
    Rays<F> rays[at_once];
    for (int k = 0; k < at_once; ++k) {
      const int cone = begin + done + k * F::lanes;
      aim(task, task.cone_cosines + cone, task.cone_sines + cone, rays[k]);
      rays[k].t = F(0.0f);
    }
    bool again = true;
    while (again) {
      again = false;
      for (int k = 0; k < at_once; ++k) again |= step_cones(task, rays[k]);
    }
    for (int k = 0; k < at_once; ++k) rays[k].t.store(reach + done + k * F::lanes);
  }
}

/// 1/x, with values near 0 replaced by a tiny one.
template <class F>
SLALOM_INLINE F inverse(const F& x, float tiny) {
  return F(1.0f) / select((x > F(-tiny)) & (x < F(tiny)), F(tiny), x);
}

template <class F>
SLALOM_INLINE void start_beams(const ScanTask& task, int first, float reach, Rays<F>& rays) {
  const F zero(0.0f), one(1.0f);
  aim(task, task.cosines + first, task.sines + first, rays);
  rays.inverse_c = inverse(rays.c, 1e-9f);
  rays.inverse_s = inverse(rays.s, 1e-9f);
  rays.ahead_x = select(rays.inverse_c > zero, one, zero);
  rays.ahead_y = select(rays.inverse_s > zero, one, zero);
  rays.t = F(reach);
  rays.first = first;
}

/// One step of beams: as far as the clearance of their cell allows, at least into the next cell. False if all
/// have arrived; then `clearance` tells at what.
template <class F>
SLALOM_INLINE_CALLS bool step_beams(const ScanTask& task, Rays<F>& rays,
                                    simd::IntPack<typename F::Target>& clearance) {
  const F px = F(task.x) + rays.t * rays.c, py = F(task.y) + rays.t * rays.s;
  const auto cell = look_up_cell(task, px, py);
  clearance = cell.clearance;
  const F to_border = max(min((to_float(cell.column) + rays.ahead_x - px) * rays.inverse_c,
                              (to_float(cell.row) + rays.ahead_y - py) * rays.inverse_s),
                          F(0.0f));
  const F step = max(to_float(clearance) * F(1.0f / 64), to_border + F(task.beyond));
  const auto goes_on = (clearance > simd::IntPack<typename F::Target>(-1)) & (rays.t < F(task.most));
  rays.t = select(goes_on, rays.t + step, rays.t);
  return any(goes_on);
}

template <class F>
SLALOM_INLINE void arrive(const ScanTask& task, const Rays<F>& rays,
                          const simd::IntPack<typename F::Target>& clearance) {
  const F longest(task.range_max);
  const F range = min(max((rays.t - F(task.beyond)) * F(task.resolution), F(0.0f)), longest);
  const auto left_the_map = clearance == simd::IntPack<typename F::Target>(-2);
  select(left_the_map, longest, range).store(task.ranges + rays.first);
}

/// Walks all beams of a block of cones. As many packs as `k` has entries are on their way at once, so that
/// look-ups hide behind arithmetic; one that has arrived makes room for the next.
template <class F, std::size_t... k>
SLALOM_INLINE_CALLS void walk_beams(const ScanTask& task, int begin, int end, const float* reach,
                                    std::index_sequence<k...>) {
  int next = begin, on_the_way = 0;
  Rays<F> rays[sizeof...(k)];
  const auto start = [&](Rays<F>& pack) {
    // If there are fewer packs than places, the first is walked once more, without effect.
    const int first = next < end ? next : begin;
    start_beams(task, first, reach[(first - begin) / cone_beams], pack);
    if (next < end) ++on_the_way;
    if (next >= end) pack.first = -1;
    next += F::lanes;
  };
  const auto walk = [&](Rays<F>& pack) {
    simd::IntPack<typename F::Target> clearance;
    if (step_beams(task, pack, clearance) || pack.first < 0) return;
    arrive(task, pack, clearance);
    --on_the_way;
    pack.first = -1;
    if (next < end) start(pack);
  };
  (start(rays[k]), ...);
  // NOLINTNEXTLINE(bugprone-infinite-loop): `walk` counts down.
  while (on_the_way > 0) (walk(rays[k]), ...);
}

/// The kernel of a scan of walls.
struct ScanWalls {
  template <class Target>
  SLALOM_KERNEL static void run(const ScanTask& given) {
    using F = Pack<simd::Unfused<Target>>;
    const ScanTask task = given;  // which the compiler then knows to stay as it is while ranges are written
    constexpr int block = scan_padding;  // cones
    const int cones = (task.beams + cone_beams - 1) / cone_beams;
    float reach[block];
    for (int begin = 0; begin < cones; begin += block) {
      const int here = cones - begin < block ? cones - begin : block;
      walk_cones<F>(task, begin, here, reach);
      walk_beams<F>(task, begin * cone_beams, (begin + here) * cone_beams, reach,
                    std::make_index_sequence<4>{});
    }
  }
};

}  // namespace slalom::sim::detail
