#pragma once

#include "slalom/gpu/kernels/normal.hpp"
#include "slalom/gpu/kernels/rollout.hpp"

/// The samples of `mppi` and `svg_mppi`: drawn, rolled out, weighed and summed in one launch.
namespace slalom::gpu {

/// Parts of a tile whose samples are summed side by side: a warp takes one.
constexpr int parts_of_tile = block_threads / 32;
/// A weight below this is 0: all such weights together change a plan less than rounding does.
constexpr float least_weight = 1e-12f;

/// The distribution of a row, and its weighted sum.
struct alignas(16) Row {
  float mean, deviation, linear, moment;
  float value(float z, float low, float high) const { return clamped(mean + deviation * z, low, high); }
};

/// Shared memory of a block: a tile of samples, whose inputs are there only where the threads draw together.
struct Tile {
  Row* row;
  GroupSums* sums;
  float *cost, *total, *weight, *hit;  ///< [sample]
  float* part;                         ///< [part][row]
  float* v;                            ///< [row][sample and one more]

  Tile(float* memory, int rows, int samples) {
    row = reinterpret_cast<Row*>(memory);
    sums = reinterpret_cast<GroupSums*>(memory + 4 * rows);
    cost = memory + 4 * rows + 8;
    total = cost + samples, weight = total + samples, hit = weight + samples, part = hit + samples;
    v = part + parts_of_tile * rows;
  }
};
constexpr int tile_floats(int rows, int tile, bool fused) {
  return (4 + parts_of_tile) * rows + 8 + 4 * tile + (fused ? 0 : rows * (tile + 1));
}

/// Rolls out a sample that its thread draws, step by step: nothing is stored. Returns the term of the mean.
template <class P, bool guided>
float roll_out_fused(const Arguments<P>& a, const Tile& t, const Key& key, int sample, Rollout<P>& rollout) {
  constexpr int steps = 8 / P::inputs;  // steps that eight normal values make
  const Settings& s = a.settings;
  float term = 0;
  const auto roll_out_octet = [&](int octet, int count) {
    float z[8];
    normal_octet(key, sample, octet, z);
    SLALOM_UNROLL_OCTET
    for (int j = 0; j < steps; ++j) {
      if (j >= count) break;
      typename Rollout<P>::Inputs u;
      SLALOM_UNROLL_ALL
      for (int i = 0; i < P::inputs; ++i) {
        const Row row = t.row[8 * octet + j * P::inputs + i];
        u[i] = row.value(z[j * P::inputs + i], s.low[i], s.high[i]);
        if constexpr (!guided) term += row.linear * u[i];
      }
      rollout.step(u, steps * octet + j);
    }
  };
  int step = 0;
  if constexpr (SLALOM_UNROLL_STEPS > 1)
    for (; step + steps <= s.horizon; step += steps) roll_out_octet(step / steps, steps);
  for (; step < s.horizon; step += steps) roll_out_octet(step / steps, s.horizon - step);
  return term;
}

/// Draws and rolls out a tile.
template <class P, bool guided>
void evaluate_tile(const Arguments<P>& a, const Tile& t, const Key& key, int first) {
  const Settings& s = a.settings;
  const int stride = s.tile + 1;
  if (!s.fused) {
    draw(key, s.horizon * P::inputs, first, log2_of(s.tile), stride, t.v, 0,
         [&](int r, int, float z) { return t.row[r].value(z, s.low[r % P::inputs], s.high[r % P::inputs]); });
    SLALOM_BARRIER();
  }
  SLALOM_EACH(k, s.tile) {
    Rollout<P> rollout(a);
    float term = 0;
    if (!s.fused) {
      roll_out<P, SLALOM_UNROLL_STEPS>(a, t.v + k, stride, rollout, [&](int r, float u) {
        if constexpr (!guided) term += t.row[r].linear * u;
      });
    } else if constexpr (can_fuse<P::inputs>) {
      term = roll_out_fused<P, guided>(a, t, key, first + k, rollout);
    }
    t.cost[k] = rollout.finish();
    t.total[k] = t.cost[k] + term, t.hit[k] = rollout.collided() ? 1.0f : 0.0f;
  }
}

/// Adds the samples of a tile, by their weights, to the moments. Those of weight 0 cost nothing; the others
/// are drawn again, which takes less time than to keep them all.
template <class P>
void add_moments(const Arguments<P>& a, const Tile& t, const Key& key, int first, float scale) {
  const Settings& s = a.settings;
  const int rows = s.horizon * P::inputs;
  SLALOM_EACH_WARP(part, parts_of_tile) {
    SLALOM_EACH_LANE(octet, (rows + 7) / 8) {
      float sum[8] = {};
      for (int k = part; k < s.tile; k += parts_of_tile) {
        const float weight = t.weight[k];
        if (!(weight > 0)) continue;
        float z[8];
        normal_octet(key, first + k, octet, z);
        SLALOM_UNROLL_ALL
        for (int j = 0; j < 8; ++j) {
          const int r = 8 * octet + j < rows ? 8 * octet + j : 0, i = r % P::inputs;
          sum[j] += weight * t.row[r].value(z[j], s.low[i], s.high[i]);
        }
      }
      SLALOM_UNROLL_ALL
      for (int j = 0; j < 8; ++j)
        if (8 * octet + j < rows) t.part[part * rows + 8 * octet + j] = sum[j];
    }
  }
  SLALOM_BARRIER();
  SLALOM_EACH(r, rows) {
    float sum = 0;
    for (int part = 0; part < parts_of_tile; ++part) sum += t.part[part * rows + r];
    t.row[r].moment = t.row[r].moment * scale + sum;
  }
}

/// Evaluates a group of tiles and sums its samples by their weights, relative to the least cost so far.
template <class P, bool guided>
void solve_group(const Arguments<P>& a, int group, float* memory) {
  const Settings& s = a.settings;
  const Buffers& b = a.buffers;
  const int rows = s.horizon * P::inputs;
  const Tile t(memory, rows, s.tile);
  SLALOM_EACH(r, rows) {
    const int i = r % P::inputs;
    if constexpr (guided) {
      t.row[r] = {b.nominal[r], sqrtf(b.variance[r]), 0, 0};
    } else {
      const float mean = shifted(b.mean, r, s.horizon, P::inputs, a.shift), variance = s.variance[i];
      t.row[r] = {mean, sqrtf(variance), variance > 0 ? s.control_factor * mean / variance : 0.0f, 0};
    }
  }
  SLALOM_ONE_THREAD()* t.sums = {infinite, infinite, 0, 0, 0, 0, 0, 0};
  SLALOM_BARRIER();
  const Key key = key_of(a.seed, a.stream);
  const float inverse_temperature = 1.0f / s.temperature;
  for (int tile = group; tile < s.tiles; tile += s.groups) {
    const int first = tile * s.tile, count = s.samples - first < s.tile ? s.samples - first : s.tile;
    evaluate_tile<P, guided>(a, t, key, first);
    SLALOM_BARRIER();
    const auto total = [&](int k) { return k < count && is_finite(t.total[k]) ? t.total[k] : infinite; };
    const GroupSums before = *t.sums;
    const float now = Least::of(reduce<Least>(s.tile, total), before.least_total);
    const float scale =
        before.least_total < infinite ? std::exp((now - before.least_total) * inverse_temperature) : 0.0f;
    SLALOM_EACH(k, s.tile) {
      const float weight = now < infinite ? std::exp((now - total(k)) * inverse_temperature) : 0.0f;
      t.weight[k] = weight >= least_weight ? weight : 0.0f;
      if (b.costs && k < count) b.costs[first + k] = t.cost[k];
    }
    SLALOM_BARRIER();
    SLALOM_ONE_WARP() {
      const auto w = [&](int k) { return t.weight[k]; };
      GroupSums sums = before;
      sums.least_total = now;
      sums.weight = before.weight * scale + reduce<Sum>(s.tile, w);
      sums.squared = before.squared * scale * scale + reduce<Sum>(s.tile, [&](int k) { return w(k) * w(k); });
      sums.cost = before.cost * scale +
                  reduce<Sum>(s.tile, [&](int k) { return w(k) > 0 ? w(k) * t.cost[k] : 0.0f; });
      sums.finite += reduce<Sum>(s.tile, [&](int k) { return total(k) < infinite ? 1.0f : 0.0f; });
      sums.collided += reduce<Sum>(s.tile, [&](int k) { return k < count ? t.hit[k] : 0.0f; });
      sums.least_cost = Least::of(
          sums.least_cost, reduce<Least>(s.tile, [&](int k) { return k < count ? t.cost[k] : infinite; }));
      SLALOM_ONE_LANE()* t.sums = sums;
    }
    add_moments(a, t, key, first, scale);
    SLALOM_BARRIER();
  }
  float* const partial = b.partial + static_cast<long long>(group) * padded_rows(rows);
  SLALOM_EACH(r, rows) partial[r] = t.row[r].moment;
  SLALOM_ONE_THREAD() b.sums[group] = *t.sums;
}

/// Into how many chunks `combine` divides the groups.
constexpr int chunks_of(int rows) {
  const int quads = padded_rows(rows) / 4;
  return block_threads / quads > 0 ? block_threads / quads : 1;
}
constexpr int combine_floats(int rows, int groups) {
  return 8 * groups + 4 + chunks_of(rows) * padded_rows(rows);
}

/// Sums the groups in a fixed order, and writes the plan and the report.
template <class P, bool guided>
void combine(const Arguments<P>& a, float* memory) {
  const Settings& s = a.settings;
  const Buffers& b = a.buffers;
  const int rows = s.horizon * P::inputs, n = s.groups, quads = padded_rows(rows) / 4,
            chunks = chunks_of(rows);
  GroupSums* const sums = reinterpret_cast<GroupSums*>(memory);
  float* const part = memory + 8 * n;  // [chunk][row, padded]
#if SLALOM_ON_GPU
  // Past the first-level cache, which may hold what was there before the other blocks wrote.
  SLALOM_EACH(t, 2 * n)
  reinterpret_cast<float4*>(sums)[t] = __ldcg(reinterpret_cast<const float4*>(b.sums) + t);
#else
  SLALOM_EACH(t, n) sums[t] = b.sums[t];
#endif
  SLALOM_BARRIER();
  const float least = reduce<Least>(n, [&](int t) { return sums[t].least_total; });
  SLALOM_EACH(t, n) {
    const float of_group = sums[t].least_total;
    sums[t].unused = of_group < infinite ? std::exp((least - of_group) / s.temperature) : 0.0f;
  }
  SLALOM_BARRIER();
  const auto f = [&](int t) { return sums[t].unused; };
  SLALOM_EACH(j, quads * chunks) {
    const int c = j / quads, q = j - c * quads;
    float x = 0, y = 0, z = 0, w = 0;
    const float* from = b.partial + 4 * q;
#if SLALOM_ON_GPU
#pragma unroll 8
#endif
    for (int t = c; t < n; t += chunks) {
      const float* at = from + static_cast<long long>(t) * quads * 4;
#if SLALOM_ON_GPU
      const float4 p = __ldcg(reinterpret_cast<const float4*>(at));
      x += f(t) * p.x, y += f(t) * p.y, z += f(t) * p.z, w += f(t) * p.w;
#else
      x += f(t) * at[0], y += f(t) * at[1], z += f(t) * at[2], w += f(t) * at[3];
#endif
    }
    float* to = part + 4 * j;
    to[0] = x, to[1] = y, to[2] = z, to[3] = w;
  }
  const float weight = reduce<Sum>(n, [&](int t) { return f(t) * sums[t].weight; });
  const float inverse = weight > 0 ? 1.0f / weight : 0.0f;
  SLALOM_BARRIER();
  SLALOM_EACH(r, rows) {
    float x = 0;
    for (int c = 0; c < chunks; ++c) x += part[c * quads * 4 + r];
    const int i = r % P::inputs;
    x = weight > 0 ? clamped(x * inverse, s.low[i], s.high[i])
        : guided   ? b.nominal[r]
                   : shifted(b.mean, r, s.horizon, P::inputs, a.shift);
    b.plan[r] = x;
    part[r] = x;
  }
  SLALOM_BARRIER();
  SLALOM_EACH(r, rows) b.mean[r] = part[r];
  SLALOM_ONE_WARP() {
    const float squared = reduce<Sum>(n, [&](int t) { return f(t) * f(t) * sums[t].squared; });
    const float cost = reduce<Sum>(n, [&](int t) { return f(t) * sums[t].cost; });
    const float least_cost = reduce<Least>(n, [&](int t) { return sums[t].least_cost; });
    const float finite = reduce<Sum>(n, [&](int t) { return sums[t].finite; });
    const float collided = reduce<Sum>(n, [&](int t) { return sums[t].collided; });
    SLALOM_ONE_THREAD() {
      b.report->least_cost = least_cost, b.report->mean_cost = cost * inverse;
      b.report->effective_samples = squared > 0 ? weight * weight / squared : 0.0f;
      b.report->finite = finite, b.report->collided = collided;
    }
  }
}

}  // namespace slalom::gpu
