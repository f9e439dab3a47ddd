#include <utility>

#include "sim/lidar/scan.hpp"
#include "slalom/core/math.hpp"

/// Distances to walls and bodies, and their noise, one beam per lane. No product is fused with a sum: all
/// instruction sets give the same bits.
namespace slalom::sim::detail {
namespace {

/// A hash of 32 bits; `U` is a vector of unsigned integers.
template <class U>
SLALOM_INLINE U hash(const U& value) {
  U x = (value ^ value >> 16) * 0x7feb352du;
  x = (x ^ x >> 15) * 0x846ca68bu;
  return x ^ x >> 16;
}

/// ln(x) for x in (0, 1]: the polynomial of S. L. Moshier's Cephes library (logf).
template <class F>
SLALOM_INLINE F log_of_fraction(const F& x) {
  using I = typename simd::IntPack<typename F::Target>::Vector;
  using V = typename F::Vector;
  const I bits = reinterpret_cast<I>(x.v);
  const I e = (bits - 0x3f3504f3) >> 23;
  const F m = F(reinterpret_cast<V>(bits - (e << 23))) - F(1.0f);
  const F n = to_float(simd::IntPack<typename F::Target>(e));
  const F m2 = m * m;
  F p = F(7.0376836292e-2f);
  p = p * m - F(1.1514610310e-1f);
  p = p * m + F(1.1676998740e-1f);
  p = p * m - F(1.2420140846e-1f);
  p = p * m + F(1.4249322787e-1f);
  p = p * m - F(1.6668057665e-1f);
  p = p * m + F(2.0000714765e-1f);
  p = p * m - F(2.4999993993e-1f);
  p = p * m + F(3.3333331174e-1f);
  return m + (m * m2 * p - n * F(2.12194440e-4f) - F(0.5f) * m2) + n * F(0.693359375f);
}

/// Sine and cosine of an angle that is counted in 2^-32 turns. Cephes' polynomials on an eighth of a turn.
template <class F>
SLALOM_INLINE void sin_cos_of_turn(const typename simd::detail::VectorTypes<F::lanes>::Unsigned& turn,
                                   F& sine, F& cosine) {
  using U = typename simd::detail::VectorTypes<F::lanes>::Unsigned;
  using I = simd::IntPack<typename F::Target>;
  using V = typename F::Vector;
  const U quarter = (turn + 0x20000000u) >> 30;
  const I rest(reinterpret_cast<typename I::Vector>(turn - (quarter << 30)));
  const F r = to_float(rest) * F(static_cast<float>(6.283185307179586 * 0x1p-32));
  const F r2 = r * r;
  const F s = r + r * r2 * (F(-1.6666654611e-1f) + r2 * (F(8.3321608736e-3f) - r2 * F(1.9515295891e-4f)));
  const F c = (F(1.0f) - F(0.5f) * r2) +
              r2 * r2 * (F(4.166664568e-2f) + r2 * (F(-1.388731625e-3f) + r2 * F(2.443315712e-5f)));
  const auto odd = I(reinterpret_cast<typename I::Vector>(quarter & 1)) == I(1);
  const F a = select(odd, c, s), b = select(odd, s, c);
  sine = F(reinterpret_cast<V>(reinterpret_cast<U>(a.v) ^ (quarter >> 1 << 31)));
  cosine = F(reinterpret_cast<V>(reinterpret_cast<U>(b.v) ^ ((quarter + 1) >> 1 << 31)));
}

/// The kernel that adds noise to the ranges of a scan and drops beams.
struct AddRangeNoise {
  template <class Target>
  SLALOM_KERNEL static void run(const NoiseTask& task) {
    using F = Pack<simd::Unfused<Target>>;
    using I = simd::IntPack<simd::Unfused<Target>>;
    using U = typename simd::detail::VectorTypes<F::lanes>::Unsigned;
    constexpr std::uint32_t sign = 0x80000000u;  // added to compare as unsigned numbers
    const F zero(0.0f), most(task.most);
    const I lost_below(static_cast<int>(task.lost_below ^ sign));
    U lane{};
    for (int i = 0; i < F::lanes; ++i) lane[i] = static_cast<std::uint32_t>(i);
    // One draw of two normal values serves a beam and the one 16 further on, for packs of any width.
    for (int first = 0; first < task.count; first += 32)
      for (int part = 0; part < 16; part += F::lanes) {
        const int at = first + part;
        const U a = hash(U(hash(U((lane + static_cast<std::uint32_t>(at)) ^ task.key0)) ^ task.key1));
        const U b = hash(U(a ^ task.key0 ^ 0x9e3779b9u));
        // 24 bits and a half, so that it is never 0.
        const F uniform = to_float(I(reinterpret_cast<typename I::Vector>(a >> 8)));
        F sine, cosine;
        sin_cos_of_turn(b, sine, cosine);
        const F radius =
            sqrt(log_of_fraction((uniform + F(0.5f)) * F(0x1p-24f)) * F(-2.0f)) * F(task.deviation);
        for (int half = 0; half < 2; ++half) {
          float* const to = task.ranges + at + 16 * half;
          const F range = F::load(to);
          F noisy = min(max(range + radius * (half ? sine : cosine), zero), most);
          if (task.lost_below > 0) {
            const U draw = hash(U(b ^ task.key1 ^ (half ? 0x85ebca6bu : 0xc2b2ae35u)));
            const I drawn(reinterpret_cast<typename I::Vector>(draw ^ sign));
            noisy = select(drawn < lost_below, most, noisy);
          }
          select(range >= most, range, noisy).store(to);
        }
      }
  }
};

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
