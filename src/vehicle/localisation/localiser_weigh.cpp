// The two loops over particles and beams, once per instruction set: the lanes are particles, the beams run
// inside, so that everything of a particle stays in registers.
#include "localiser_sensor.hpp"
#include "slalom/core/dispatch.hpp"
#include "slalom/core/math.hpp"

namespace slalom::vehicle::detail {
namespace {

/// Likelihoods from a field of distances.
struct ByField {
  template <class Target>
  SLALOM_KERNEL static void run(const WeighInput& in) {
    using F = Pack<Target>;
    const ScanBeams& beams = *in.beams;
    const F mean(1.0f / static_cast<float>(beams.hits));
    for (int i = 0; i < in.particles.count; i += F::lanes) {
      const F x = F::load(in.particles.x + i), y = F::load(in.particles.y + i);
      F s, c;
      sin_cos(F::load(in.particles.yaw + i), s, c);
      F sum(0.0f);
      for (int k = 0; k < beams.hits; ++k) {
        const F end_x(beams.end_x[k]), end_y(beams.end_y[k]);
        sum = sum + look_up(in.field, x + end_x * c - end_y * s, y + end_x * s + end_y * c);
      }
      (sum * mean + look_up(in.place, x, y)).store(in.log_fit + i);
    }
  }
};

/// The range between two angles of a table, and the difference of the ranges at these angles, m.
template <class Target>
struct Expected {
  Pack<Target> range, difference;
};

template <class Target>
SLALOM_INLINE Expected<Target> expected_range(const WeighInput& in,
                                              const typename simd::IntPack<Target>::Vector& index,
                                              const Pack<Target>& fraction) {
  using F = Pack<Target>;
  using I = typename simd::IntPack<Target>::Vector;
  F entry;
  simd::Operations<Target>::gather(reinterpret_cast<const float*>(in.pairs), index, entry.v);
  const I bits = reinterpret_cast<I>(entry.v);
  const F here(__builtin_convertvector(bits & 0xffff, typename F::Vector));
  const F next(__builtin_convertvector((bits >> 16) & 0xffff, typename F::Vector));
  const F difference = (next - here) * F(in.range_unit);
  return {here * F(in.range_unit) + fraction * difference, difference};
}

/// The distance (m) of a position from the centre of its cell, along an axis that is counted against it.
template <class Target>
SLALOM_INLINE Pack<Target> from_cell_center(const GridAxis& axis, double resolution,
                                            const Pack<Target>& position) {
  using F = Pack<Target>;
  using I = typename simd::IntPack<Target>::Vector;
  const F cells = position * F(static_cast<float>(axis.scale)) + F(static_cast<float>(axis.offset));
  const F whole(__builtin_convertvector(__builtin_convertvector(cells.v, I), typename F::Vector));
  return (F(0.5f) - (cells - whole)) * F(static_cast<float>(resolution));
}

/// Likelihoods from a table of expected ranges.
struct ByRanges {
  template <class Target>
  SLALOM_KERNEL static void run(const WeighInput& in) {
    using F = Pack<Target>;
    using I = typename simd::IntPack<Target>::Vector;
    const ScanBeams& beams = *in.beams;
    const F mean(1.0f / static_cast<float>(beams.count)), angles(static_cast<float>(table_angles));
    const F laser_x(in.laser_x), laser_y(in.laser_y);
    for (int i = 0; i < in.particles.count; i += F::lanes) {
      const F x = F::load(in.particles.x + i), y = F::load(in.particles.y + i);
      const F yaw = F::load(in.particles.yaw + i);
      F s, c;
      sin_cos(yaw, s, c);
      const F from_x = x + laser_x * c - laser_y * s, from_y = y + laser_x * s + laser_y * c;
      const F cell = look_up(in.rows, from_x, from_y);
      const F off_x = from_cell_center(in.rows.rows_axis(), in.rows.resolution(), from_x);
      const F off_y = from_cell_center(in.rows.columns_axis(), in.rows.resolution(), from_y);
      const F off_forward = off_x * c + off_y * s, off_left = off_y * c - off_x * s;
      const I row = __builtin_convertvector(cell.v, I) * table_angles;
      const F turns = wrap_angle(yaw) * F(0.15915494309f);  // -1/2 .. 1/2
      const F start = select(turns < F(0.0f), turns + F(1.0f), turns) * angles;
      const auto expected_at = [&](int k) {
        const F sum = start + F(beams.bin[k]);
        const F bin = select(sum >= angles, sum - angles, sum);
        const I whole = __builtin_convertvector(min(bin, angles - F(1.0f)).v, I);
        return expected_range<Target>(in, row + whole,
                                      bin - F(__builtin_convertvector(whole, typename F::Vector)));
      };
      F total(0.0f);
      for (int k = 0; k < beams.hits; ++k) {
        const std::size_t beam = static_cast<std::size_t>(k);
        const F range(beams.range[beam]), steepest(beams.steepest[beam]);
        const auto [at_center, difference] = expected_at(k);
        const F straight = select(difference * difference > steepest * steepest, F(0.0f), difference);
        const F expected =
            at_center - (off_forward * F(beams.forward_x[beam]) + off_left * F(beams.forward_y[beam])) +
            straight * (off_forward * F(beams.sideways_x[beam]) + off_left * F(beams.sideways_y[beam]));
        const F before(in.short_scale * __builtin_expf(-in.short_rate * beams.range[beam]));
        const F off = range - expected;
        const F p = F(in.hit) * exp(off * off * F(in.hit_scale)) + F(in.random) +
                    select(range < expected, before, F(0.0f));
        total = total + log(p);
      }
      for (int k = beams.hits; k < beams.count; ++k)
        total = total + select(expected_at(k).range >= F(in.nothing_from), F(0.0f), F(in.lost));
      (total * mean + look_up(in.place, x, y)).store(in.log_fit + i);
    }
  }
};

}  // namespace

void weigh_by_field(const WeighInput& input) noexcept {
  simd::dispatch<ByField>(input);
}
void weigh_by_ranges(const WeighInput& input) noexcept {
  simd::dispatch<ByRanges>(input);
}

}  // namespace slalom::vehicle::detail
