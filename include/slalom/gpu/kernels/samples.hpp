#pragma once

#include "slalom/gpu/kernels/normal.hpp"
#include "slalom/gpu/kernels/rollout.hpp"

/// The samples of `mppi` and `svg_mppi`: drawn, rolled out, weighed and summed in one launch.
namespace slalom::gpu {

/// Parts of a tile whose samples are summed side by side: a warp takes one.
constexpr int parts_of_tile = block_threads / 32;
/// A weight below this is 0: all such weights together change a plan less than rounding does.
constexpr float least_weight = 1e-12f;
/// Whether a thread can draw the sample that it rolls out: eight normal values are whole steps.
template <class P>
constexpr bool can_fuse = 8 % P::inputs == 0;

/// The distribution of a row, and its weighted sum.
struct alignas(16) Row {
  float mean, deviation, moment;
};

/// Floats of the shared memory of `SampleBlock`.
constexpr int sample_floats(int rows, int tile, bool fused) {
  return (4 + parts_of_tile) * rows + 8 + 3 * tile + (fused ? 0 : rows * (tile + 1));
}

/// The work of a block on its groups of tiles.
template <class P>
struct SampleBlock {
  const Arguments<P>& a;
  float* const memory;
  const Settings& s = a.settings;
  const Buffers& b = a.buffers;
  const int rows = s.horizon * P::inputs;
  Row* const row = reinterpret_cast<Row*>(memory);  ///< [row]
  GroupSums* const sums = reinterpret_cast<GroupSums*>(memory + 4 * rows);
  float* const cost = memory + 4 * rows + 8;  ///< [sample], as the next two
  float *const weight = cost + s.tile, *const hit = weight + s.tile;
  float* const part_sum = hit + s.tile;              ///< [part][row]
  float* const v = part_sum + parts_of_tile * rows;  ///< [row][sample, one more], where threads draw together
  const Key key = key_of(a.seed, a.stream);

  /// Input `r` of a sample, from a normal value.
  float input(int r, float z) const {
    const Row of = row[r];
    return clamped(of.mean + of.deviation * z, s.low[input_of<P>(r)], s.high[input_of<P>(r)]);
  }

  /// Rolls out a sample that its thread draws, step by step: nothing is stored.
  void roll_out_fused(int sample, Rollout<P>& rollout) const {
    constexpr int steps = 8 / P::inputs;  // steps that eight normal values make
    const auto roll_out_octet = [&](int octet, int count) {
      float z[8];
      normal_octet(key, sample, octet, z);
      SLALOM_UNROLLED(unrolled_steps<P>() == 1 ? 1 : steps)
      for (int j = 0; j < steps; ++j) {
        if (j >= count) break;
        typename Rollout<P>::Inputs u;
        SLALOM_UNROLLED()
        for (int i = 0; i < P::inputs; ++i) u[i] = input(8 * octet + j * P::inputs + i, z[j * P::inputs + i]);
        rollout.step(u, steps * octet + j);
      }
    };
    int step = 0;
    if constexpr (unrolled_steps<P>() != 1)
      for (; step + steps <= s.horizon; step += steps) roll_out_octet(step / steps, steps);
    for (; step < s.horizon; step += steps) roll_out_octet(step / steps, s.horizon - step);
  }

  /// Draws and rolls out a tile.
  void evaluate(int first) const {
    if (!s.fused) {
      draw(key, rows, first, log2_of(s.tile), s.tile + 1, v, 0, [&](int r, float z) { return input(r, z); });
      Block::barrier();
    }
    Block::each(s.tile, [&](int k) {
      Rollout<P> rollout(a);
      if (!s.fused) {
        roll_out<unrolled_steps<P>()>(a, rollout, [&](int r) { return v[r * (s.tile + 1) + k]; });
      } else if constexpr (can_fuse<P>) {
        roll_out_fused(first + k, rollout);
      }
      cost[k] = rollout.finish();
      hit[k] = rollout.collided() ? 1.0f : 0.0f;
    });
  }

  /// Adds the samples of a tile, by their weights, to the moments. Those of weight 0 cost nothing; the others
  /// are drawn again, which takes less time than to keep them all.
  void add_moments(int first, float scale) const {
    for (int part = Block::warp(); part < parts_of_tile; part += Block::warps()) {
      for (int octet = Block::lane(); octet < (rows + 7) / 8; octet += Block::lanes) {
        float sum[8] = {};
        for (int k = part; k < s.tile; k += parts_of_tile) {
          const float w = weight[k];
          if (!(w > 0)) continue;
          float z[8];
          normal_octet(key, first + k, octet, z);
          SLALOM_UNROLLED()
          for (int j = 0; j < 8; ++j) sum[j] += w * input(8 * octet + j < rows ? 8 * octet + j : 0, z[j]);
        }
        SLALOM_UNROLLED()
        for (int j = 0; j < 8; ++j)
          if (8 * octet + j < rows) part_sum[part * rows + 8 * octet + j] = sum[j];
      }
    }
    Block::barrier();
    Block::each(rows, [&](int r) {
      float sum = 0;
      for (int part = 0; part < parts_of_tile; ++part) sum += part_sum[part * rows + r];
      row[r].moment = row[r].moment * scale + sum;
    });
  }

  /// Weighs the samples of a tile relative to the least cost so far, and adds them to the sums. Returns the
  /// factor of the sums so far.
  float add_weights(int first, int count) const {
    const auto known = [&](int k) { return k < count ? cost[k] : infinite; };
    const auto w = [&](int k) { return weight[k]; };
    const GroupSums before = *sums;
    const float inverse_temperature = 1.0f / s.temperature;
    const float now = fminf(Block::least(s.tile, known), before.least);
    const float scale = before.least < infinite ? std::exp((now - before.least) * inverse_temperature) : 0.0f;
    Block::each(s.tile, [&](int k) {
      const float of = now < infinite ? std::exp((now - known(k)) * inverse_temperature) : 0.0f;
      weight[k] = of >= least_weight ? of : 0.0f;
      if (b.costs && k < count) b.costs[first + k] = cost[k];
    });
    Block::barrier();
    if (Block::thread() < Block::lanes) {
      GroupSums all = before;
      all.least = now;
      all.weight = before.weight * scale + Block::sum(s.tile, w);
      all.squared = before.squared * scale * scale + Block::sum(s.tile, [&](int k) { return w(k) * w(k); });
      all.cost =
          before.cost * scale + Block::sum(s.tile, [&](int k) { return w(k) > 0 ? w(k) * cost[k] : 0.0f; });
      all.finite += Block::sum(s.tile, [&](int k) { return known(k) < infinite ? 1.0f : 0.0f; });
      all.collided += Block::sum(s.tile, [&](int k) { return k < count ? hit[k] : 0.0f; });
      if (Block::thread() == 0) *sums = all;
    }
    return scale;
  }

  /// Evaluates a group of tiles and sums its samples by their weights.
  void solve(int group) const {
    Block::each(rows, [&](int r) {
      const float variance = s.guides > 0 ? b.variance[r] : s.variance[input_of<P>(r)];
      const float mean = s.guides > 0 ? b.nominal[r] : shifted(a, b.mean, r);
      row[r] = {mean, sqrtf(variance), 0};
    });
    if (Block::thread() == 0) *sums = {infinite, 0, 0, 0, 0, 0, 0, 0};
    Block::barrier();
    for (int tile = group; tile < s.tiles; tile += s.groups) {
      const int first = tile * s.tile;
      evaluate(first);
      Block::barrier();
      const float scale = add_weights(first, s.samples - first < s.tile ? s.samples - first : s.tile);
      add_moments(first, scale);
      Block::barrier();
    }
    Block::each(rows, [&](int r) {
      b.partial[static_cast<long long>(group) * padded_rows(rows) + r] = row[r].moment;
    });
    if (Block::thread() == 0) b.sums[group] = *sums;
    Block::barrier();
  }
};

/// Into how many chunks `combine` divides the groups.
constexpr int chunks_of(int rows) {
  const int quads = padded_rows(rows) / 4;
  return block_threads / quads > 0 ? block_threads / quads : 1;
}
constexpr int combine_floats(int rows, int groups) {
  return 8 * groups + chunks_of(rows) * padded_rows(rows);
}

/// Sums the groups in a fixed order, and writes the plan and the report. The last block does so.
template <class P>
void combine(const Arguments<P>& a, float* memory) {
  const Settings& s = a.settings;
  const Buffers& b = a.buffers;
  const int rows = s.horizon * P::inputs, n = s.groups, quads = padded_rows(rows) / 4,
            chunks = chunks_of(rows);
  GroupSums* const sums = reinterpret_cast<GroupSums*>(memory);
  Four* const part = reinterpret_cast<Four*>(memory + 8 * n);  // [chunk][four rows]
  float* const row = memory + 8 * n;                           // [chunk][row, padded]
  Block::each(2 * n, [&](int j) {
    reinterpret_cast<Four*>(sums)[j] = Block::read_written(reinterpret_cast<const float*>(b.sums) + 4 * j);
  });
  Block::barrier();
  const float least = Block::least(n, [&](int t) { return sums[t].least; });
  Block::each(n, [&](int t) {
    const float of_group = sums[t].least;
    sums[t].factor = of_group < infinite ? std::exp((least - of_group) / s.temperature) : 0.0f;
  });
  Block::barrier();
  const auto f = [&](int t) { return sums[t].factor; };
  Block::each(quads * chunks, [&](int j) {
    const int c = j / quads, q = j - c * quads;
    Four sum{0, 0, 0, 0};
    SLALOM_UNROLLED(8)
    for (int t = c; t < n; t += chunks) {
      const Four p = Block::read_written(b.partial + 4 * (static_cast<long long>(t) * quads + q));
      sum.x += f(t) * p.x, sum.y += f(t) * p.y, sum.z += f(t) * p.z, sum.w += f(t) * p.w;
    }
    part[j] = sum;
  });
  const float weight = Block::sum(n, [&](int t) { return f(t) * sums[t].weight; });
  const float inverse = weight > 0 ? 1.0f / weight : 0.0f;
  Block::barrier();
  Block::each(rows, [&](int r) {
    float x = 0;
    for (int c = 0; c < chunks; ++c) x += row[c * quads * 4 + r];
    x = weight > 0     ? clamped(x * inverse, s.low[input_of<P>(r)], s.high[input_of<P>(r)])
        : s.guides > 0 ? b.nominal[r]
                       : shifted(a, b.mean, r);
    b.plan[r] = x;
    row[r] = x;
  });
  Block::barrier();
  Block::each(rows, [&](int r) { b.mean[r] = row[r]; });
  if (Block::thread() < Block::lanes) {
    const float squared = Block::sum(n, [&](int t) { return f(t) * f(t) * sums[t].squared; });
    const float cost = Block::sum(n, [&](int t) { return f(t) * sums[t].cost; });
    const float finite = Block::sum(n, [&](int t) { return sums[t].finite; });
    const float collided = Block::sum(n, [&](int t) { return sums[t].collided; });
    if (Block::thread() == 0) {
      b.report->least_cost = least, b.report->mean_cost = cost * inverse;
      b.report->effective_samples = squared > 0 ? weight * weight / squared : 0.0f;
      b.report->finite = finite, b.report->collided = collided;
    }
  }
}

}  // namespace slalom::gpu
