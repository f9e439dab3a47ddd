#pragma once

#include <utility>

#include "sim/lidar/lanes.hpp"
#include "sim/lidar/scan.hpp"

/// The loops of a scan over packs of beams, written once and compiled in a file per instruction set.
namespace slalom::sim::detail {
namespace {

/// A pack of rays on its way, `t` cells far from the sensor.
template <class L>
struct Rays {
  typename L::F t, c, s;  ///< way, and direction in the grid
  typename L::F inverse_c, inverse_s;
  typename L::F ahead_x, ahead_y;  ///< 1 where the next border lies on the larger side of a cell, else 0
  int first;                       ///< beam or cone
};

template <class L>
inline void aim(const ScanTask& task, const float* cosines, const float* sines, Rays<L>& rays) {
  typename L::F c, s;
  L::load(cosines, c);
  L::load(sines, s);
  rays.c = task.cosine * c - task.sine * s;
  rays.s = task.sine * c + task.cosine * s;
}

/// What the field says where the rays are.
template <class L>
inline void look_up(const ScanTask& task, const typename L::F& px, const typename L::F& py,
                    typename L::I& column, typename L::I& row, typename L::I& free) {
  L::to_int(px, column);
  L::to_int(py, row);
  L::gather(task.clearance, row * task.stride + column, free);
}

/// One step of cones, which goes as far as no beam of theirs can meet a wall; false if none had one to go.
template <class L>
inline bool step_cones(const ScanTask& task, Rays<L>& rays) {
  constexpr float scale = 1.0f / 64, worth_a_step = 1.0f;  // cells
  typename L::I column, row, free;
  look_up<L>(task, task.x + rays.t * rays.c, task.y + rays.t * rays.s, column, row, free);
  typename L::F step;
  L::to_float(free, step);
  step = step * scale - rays.t * task.cone_width;
  const typename L::I goes_on = (step > worth_a_step) & (rays.t < task.most);
  rays.t = goes_on ? rays.t + step : rays.t;
  return L::any(goes_on);
}

/// Fills `reach` for all cones, four packs at a time so that the look-ups of one hide behind the others'
/// arithmetic.
template <class L>
inline void walk_cones(const ScanTask& task, int begin, int count, float* reach) {
  constexpr int at_once = 4;
  for (int done = 0; done < count; done += at_once * L::lanes) {
    Rays<L> rays[at_once];
    for (int k = 0; k < at_once; ++k) {
      const int cone = begin + done + k * L::lanes;
      aim(task, task.cone_cosines + cone, task.cone_sines + cone, rays[k]);
      rays[k].t = typename L::F{};
    }
    bool again = true;
    while (again) {
      again = false;
      for (int k = 0; k < at_once; ++k) again |= step_cones(task, rays[k]);
    }
    for (int k = 0; k < at_once; ++k) L::store(rays[k].t, reach + done + k * L::lanes);
  }
}

template <class L>
inline void start_beams(const ScanTask& task, int first, float reach, Rays<L>& rays) {
  using F = typename L::F;
  constexpr float tiny = 1e-9f;
  const F zero = F{};
  aim(task, task.cosines + first, task.sines + first, rays);
  rays.inverse_c = 1.0f / (((rays.c > -tiny) & (rays.c < tiny)) ? zero + tiny : rays.c);
  rays.inverse_s = 1.0f / (((rays.s > -tiny) & (rays.s < tiny)) ? zero + tiny : rays.s);
  rays.ahead_x = rays.inverse_c > zero ? zero + 1.0f : zero;
  rays.ahead_y = rays.inverse_s > zero ? zero + 1.0f : zero;
  rays.t = zero + reach;
  rays.first = first;
}

/// One step of beams: as far as the clearance of their cell allows, at least into the next cell. False if all
/// have arrived; then `free` tells at what.
template <class L>
inline bool step_beams(const ScanTask& task, Rays<L>& rays, typename L::I& free) {
  using F = typename L::F;
  constexpr float scale = 1.0f / 64;
  const F px = task.x + rays.t * rays.c, py = task.y + rays.t * rays.s;
  typename L::I column, row;
  look_up<L>(task, px, py, column, row, free);
  F corner_x, corner_y, step, to_border;
  L::to_float(column, corner_x);
  L::to_float(row, corner_y);
  L::to_float(free, step);
  L::min((corner_x + rays.ahead_x - px) * rays.inverse_c, (corner_y + rays.ahead_y - py) * rays.inverse_s,
         to_border);
  L::max(to_border, F{}, to_border);
  L::max(step * scale, to_border + task.beyond, step);
  const typename L::I goes_on = (free >= 0) & (rays.t < task.most);
  rays.t = goes_on ? rays.t + step : rays.t;
  return L::any(goes_on);
}

template <class L>
inline void arrive(const ScanTask& task, const Rays<L>& rays, const typename L::I& free) {
  using F = typename L::F;
  const F longest = F{} + task.range_max;
  F range;
  L::max((rays.t - task.beyond) * task.resolution, F{}, range);
  L::min(range, longest, range);
  L::store(free == -2 ? longest : range, task.ranges + rays.first);
}

/// Walks all beams of a block of cones. As many packs as `k` has entries are on their way at once, for the
/// same reason as above; one that has arrived makes room for the next, so that none waits for the slowest.
template <class L, std::size_t... k>
inline void walk_beams(const ScanTask& task, int begin, int end, const float* reach,
                       std::index_sequence<k...>) {
  int next = begin, on_the_way = 0;
  Rays<L> rays[sizeof...(k)];
  const auto start = [&](Rays<L>& pack) {
    // Where there are fewer packs than places the first is walked once more, for nothing.
    const int first = next < end ? next : begin;
    start_beams(task, first, reach[(first - begin) / cone_beams], pack);
    if (next < end) ++on_the_way;
    if (next >= end) pack.first = -1;
    next += L::lanes;
  };
  const auto walk = [&](Rays<L>& pack) {
    typename L::I free;
    if (step_beams(task, pack, free) || pack.first < 0) return;
    arrive(task, pack, free);
    --on_the_way;
    pack.first = -1;
    if (next < end) start(pack);
  };
  (start(rays[k]), ...);
  while (on_the_way > 0) (walk(rays[k]), ...);
}

template <class L, int K>
inline void scan_with(const ScanTask& given) {
  const ScanTask task = given;  // which the compiler then knows to stay as it is while ranges are written
  constexpr int block = scan_padding;  // cones
  const int cones = (task.beams + cone_beams - 1) / cone_beams;
  float reach[block];
  for (int begin = 0; begin < cones; begin += block) {
    const int here = cones - begin < block ? cones - begin : block;
    walk_cones<L>(task, begin, here, reach);
    walk_beams<L>(task, begin * cone_beams, (begin + here) * cone_beams, reach,
                  std::make_index_sequence<K>{});
  }
}

/// Ray against box by slabs (Kay & Kajiya, "Ray Tracing Complex Scenes", 1986), or against a disc.
template <class L>
inline void cast_with(const CastTask& task) {
  using F = typename L::F;
  constexpr float none = 1e30f, tiny = 1e-12f;
  const F zero = F{};
  for (int first = task.first; first <= task.last; first += L::lanes) {
    F c, s, range;
    // The last pack steps back where it would pass the window: it sees some beams twice, which changes
    // nothing.
    const int at =
        first + L::lanes - 1 > task.last && task.last >= L::lanes - 1 ? task.last - L::lanes + 1 : first;
    L::load(task.cosines + at, c);
    L::load(task.sines + at, s);
    L::load(task.ranges + at, range);
    const F dx = task.cosine * c - task.sine * s, dy = task.sine * c + task.cosine * s;
    F distance;
    if (task.radius > 0) {
      const F along = -(task.x * dx + task.y * dy), across = task.x * dy - task.y * dx;
      const F under = task.radius * task.radius - across * across;
      F half;
      L::max(under, zero, half);
      L::sqrt(half, half);
      const F near = along - half, far = along + half;
      distance = near >= zero ? near : far;
      distance = ((under < zero) | (far < zero)) ? zero + none : distance;
    } else {
      const F ix = 1.0f / (((dx > -tiny) & (dx < tiny)) ? zero + tiny : dx);
      const F iy = 1.0f / (((dy > -tiny) & (dy < tiny)) ? zero + tiny : dy);
      const F x0 = (-task.half_length - task.x) * ix, x1 = (task.half_length - task.x) * ix;
      const F y0 = (-task.half_width - task.y) * iy, y1 = (task.half_width - task.y) * iy;
      F enter_x, enter_y, leave_x, leave_y, enter, leave;
      L::min(x0, x1, enter_x);
      L::max(x0, x1, leave_x);
      L::min(y0, y1, enter_y);
      L::max(y0, y1, leave_y);
      L::max(enter_x, enter_y, enter);
      L::min(leave_x, leave_y, leave);
      distance = enter >= zero ? enter : leave;
      distance = ((enter > leave) | (leave < zero)) ? zero + none : distance;
    }
    L::min(distance, range, range);
    L::store(range, task.ranges + at);
  }
}

template <class U>
inline U hash(U x) {
  x = (x ^ x >> 16) * 0x7feb352du;
  x = (x ^ x >> 15) * 0x846ca68bu;
  return x ^ x >> 16;
}

/// ln(x) for x in (0, 1]: the polynomial of S. L. Moshier's Cephes library (logf).
template <class L>
inline void log(const typename L::F& x, typename L::F& r) {
  using F = typename L::F;
  using I = typename L::I;
  const I bits = reinterpret_cast<I>(x);
  const I e = (bits - 0x3f3504f3) >> 23;
  const F m = reinterpret_cast<F>(bits - (e << 23)) - 1.0f;
  F n;
  L::to_float(e, n);
  const F m2 = m * m;
  F p = F{} + 7.0376836292e-2f;
  p = p * m - 1.1514610310e-1f;
  p = p * m + 1.1676998740e-1f;
  p = p * m - 1.2420140846e-1f;
  p = p * m + 1.4249322787e-1f;
  p = p * m - 1.6668057665e-1f;
  p = p * m + 2.0000714765e-1f;
  p = p * m - 2.4999993993e-1f;
  p = p * m + 3.3333331174e-1f;
  r = m + (m * m2 * p - n * 2.12194440e-4f - 0.5f * m2) + n * 0.693359375f;
}

/// Sine and cosine of a turn's part: `turn` counts 2^-32 turns. Cephes' polynomials on an eighth of a turn.
template <class L>
inline void sine_cosine(const typename L::U& turn, typename L::F& sine, typename L::F& cosine) {
  using F = typename L::F;
  using I = typename L::I;
  using U = typename L::U;
  const U quarter = (turn + 0x20000000u) >> 30;
  const I rest = reinterpret_cast<I>(turn - (quarter << 30));
  F r;
  L::to_float(rest, r);
  r = r * static_cast<float>(6.283185307179586 * 0x1p-32);
  const F r2 = r * r;
  const F s = r + r * r2 * (-1.6666654611e-1f + r2 * (8.3321608736e-3f - r2 * 1.9515295891e-4f));
  const F c =
      (1.0f - 0.5f * r2) + r2 * r2 * (4.166664568e-2f + r2 * (-1.388731625e-3f + r2 * 2.443315712e-5f));
  const I odd = reinterpret_cast<I>(U{} - (quarter & 1));
  const F a = odd ? c : s, b = odd ? s : c;
  sine = reinterpret_cast<F>(reinterpret_cast<U>(a) ^ (quarter >> 1 << 31));
  cosine = reinterpret_cast<F>(reinterpret_cast<U>(b) ^ ((quarter + 1) >> 1 << 31));
}

template <class L>
inline void noise_with(const NoiseTask& task) {
  using F = typename L::F;
  using I = typename L::I;
  using U = typename L::U;
  const F zero = F{}, most = zero + task.most;
  U lane = U{};
  for (int i = 0; i < L::lanes; ++i) lane[i] = static_cast<std::uint32_t>(i);
  // One draw of two normal values serves a beam and the one 16 further on, so that packs of any width agree.
  for (int first = 0; first < task.count; first += 32)
    for (int part = 0; part < 16; part += L::lanes) {
      const int at = first + part;
      const U a = hash(hash((lane + static_cast<std::uint32_t>(at)) ^ task.key0) ^ task.key1);
      const U b = hash(a ^ task.key0 ^ 0x9e3779b9u);
      // 24 bits and a half, so that it is never 0.
      F uniform;
      L::to_float(reinterpret_cast<I>(a >> 8), uniform);
      F radius, sine, cosine;
      log<L>((uniform + 0.5f) * 0x1p-24f, radius);
      L::sqrt(radius * -2.0f, radius);
      sine_cosine<L>(b, sine, cosine);
      radius *= task.deviation;
      for (int half = 0; half < 2; ++half) {
        float* const to = task.ranges + at + 16 * half;
        F range, noisy;
        L::load(to, range);
        L::max(range + radius * (half ? sine : cosine), zero, noisy);
        L::min(noisy, most, noisy);
        if (task.lost_below > 0) {
          const U draw = hash(b ^ task.key1 ^ (half ? 0x85ebca6bu : 0xc2b2ae35u));
          noisy = draw < U{} + task.lost_below ? most : noisy;
        }
        L::store(range >= most ? range : noisy, to);
      }
    }
}

/// The distance that f1tenth_gym looks up at (x, y).
template <class L>
inline void gym_look_up(const GymWalkTask& task, const typename L::D& x, const typename L::D& y,
                        typename L::D& distance) {
  using D = typename L::D;
  const D dx = x - task.origin_x, dy = y - task.origin_y, zero = D{};
  const D gx = dx * task.origin_cosine + dy * task.origin_sine,
          gy = -dx * task.origin_sine + dy * task.origin_cosine;
  const typename L::M inside =
      (gx >= 0) & (gy >= 0) & (gx < task.width * task.resolution) & (gy < task.height * task.resolution);
  const auto column = __builtin_convertvector((inside ? gx : zero) / task.resolution, typename L::J),
             row = __builtin_convertvector((inside ? gy : zero) / task.resolution, typename L::J);
  const auto in = __builtin_convertvector(inside, typename L::J);
  const typename L::J last = typename L::J{} + (task.width * task.height - 1);
  L::gather(task.distance, (in & (row * task.width + column)) | (~in & last), distance);
}

/// Four packs at a time, so that the look-ups of one hide behind those of the others.
template <class L>
void gym_walk_with(const GymWalkTask& given) {
  using D = typename L::D;
  constexpr int lanes = L::lanes / 2, at_once = 4;
  constexpr double close_enough = 1e-4;  // m, to a wall
  const GymWalkTask task = given;
  const D most = D{} + task.most;
  for (int first = 0; first < scan_padding; first += at_once * lanes) {
    D x[at_once], y[at_once], cosine[at_once], sine[at_once], step[at_once] = {}, total[at_once];
    for (int k = 0; k < at_once; ++k) {
      std::memcpy(&cosine[k], task.cosines + first + k * lanes, sizeof(D));
      std::memcpy(&sine[k], task.sines + first + k * lanes, sizeof(D));
      x[k] = D{} + task.x;
      y[k] = D{} + task.y;
      gym_look_up<L>(task, x[k], y[k], step[k]);
      total[k] = step[k];
    }
    for (bool again = true; again;) {
      again = false;
      for (int k = 0; k < at_once; ++k) {
        const typename L::M goes_on = (step[k] > close_enough) & (total[k] <= most);
        x[k] = goes_on ? x[k] + step[k] * cosine[k] : x[k];
        y[k] = goes_on ? y[k] + step[k] * sine[k] : y[k];
        D next;
        gym_look_up<L>(task, x[k], y[k], next);
        step[k] = goes_on ? next : step[k];
        total[k] = goes_on ? total[k] + next : total[k];
        again |= L::any(goes_on);
      }
    }
    for (int k = 0; k < at_once; ++k) {
      const D range = total[k] > most ? most : total[k];
      std::memcpy(task.ranges + first + k * lanes, &range, sizeof(D));
    }
  }
}

/// `K` packs at a time.
template <class L, int K>
constexpr Kernels kernels_of(const char* name) {
  return {scan_with<L, K>, cast_with<L>, noise_with<L>, gym_walk_with<L>, name};
}

}  // namespace
}  // namespace slalom::sim::detail
