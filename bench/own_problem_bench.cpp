// Rollouts of a problem that meets the concept, compared with code written for it by hand: the differential
// drive among three discs, 30 steps, 1024 samples. The bench checks that both compute the same costs.

#include <benchmark/benchmark.h>

#include <cstdlib>

#include "slalom/core/problem_evaluator.hpp"
#include "slalom/core/random.hpp"
#include "slalom/problems/differential_drive.hpp"

namespace slalom {
namespace {

constexpr int steps = 30, samples = 1024;

#if SLALOM_X86
/// Sixteen samples at a time in vectors of this processor's width, for this problem only.
template <class Target>
struct HandTuned {
  using V = Pack<Target>;
  problems::DifferentialDrive robot;
  V goal_x{robot.goal_x}, goal_y{robot.goal_y}, dt{robot.dt};
  V disc_x[3], disc_y[3], square_radius[3];

  HandTuned() {
    for (int i = 0; i < 3; ++i) {
      const auto& disc = robot.discs[static_cast<std::size_t>(i)];
      disc_x[i] = V(disc.x), disc_y[i] = V(disc.y), square_radius[i] = V(disc.radius * disc.radius);
    }
  }
};

SLALOM_ISA_AVX2 SLALOM_TARGET_GENERIC void hand_tuned_avx2(const SequenceBatch& batch, float* costs) {
  using V = Pack<simd::Avx2>;
  const HandTuned<simd::Avx2> h;
  const V hundred(100.0f), tenth(0.1f), five(5.0f), zero(0.0f);
  for (int k = 0; k < batch.samples(); k += 2 * V::lanes) {
    V x[2] = {zero, zero}, y[2] = {zero, zero}, yaw[2] = {zero, zero}, total[2] = {zero, zero};
    for (int t = 0; t <= batch.steps(); ++t) {
      for (int j = 0; j < 2; ++j) {
        const V dx = x[j] - h.goal_x, dy = y[j] - h.goal_y;
        const V distance = sqrt(dx * dx + dy * dy);
        simd::Mask<simd::Avx2> inside(false);
        for (int i = 0; i < 3; ++i) {
          const V a = x[j] - h.disc_x[i], b = y[j] - h.disc_y[i];
          inside = inside | (a * a + b * b < h.square_radius[i]);
        }
        total[j] += distance + select(inside, hundred, zero);
        if (t == batch.steps()) {
          total[j] += five * distance;
          continue;
        }
        const V speed = V::load(batch.row(t, 0) + k + j * V::lanes);
        const V rate = V::load(batch.row(t, 1) + k + j * V::lanes);
        total[j] += tenth * rate * rate;
        V s, c;
        sin_cos(yaw[j], s, c);
        const V way = h.dt * speed;
        x[j] += way * c;
        y[j] += way * s;
        yaw[j] += h.dt * rate;
      }
    }
    for (int j = 0; j < 2; ++j) total[j].store(costs + k + j * V::lanes);
  }
}
#endif

struct Work {
  SequenceBatch batch{steps, 2, samples};
  std::vector<float> costs = std::vector<float>(padded(samples));
  std::vector<std::uint8_t> collided = std::vector<std::uint8_t>(padded(samples));
  Work() {
    fill_normal(batch, 0, batch.stride(), {1, 2});
    for (int t = 0; t < steps; ++t)
      for (int k = 0; k < batch.stride(); ++k) batch.row(t, 0)[k] += 1;
  }
  double sum() const {
    double all = 0;
    for (int k = 0; k < samples; ++k) all += static_cast<double>(costs[static_cast<std::size_t>(k)]);
    return all;
  }
};

void report(benchmark::State& state) {
  state.counters["ns/step"] =
      benchmark::Counter(1e-9 * steps * samples * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// The robot with all optional parts of a problem: cost in named terms, bounds on inputs and on their rates.
struct WithParts : problems::DifferentialDrive {
  static constexpr std::array cost_names{"distance", "turning", "collision"};
  double input_min = -2, input_max = 2;
  std::array<double, 2> input_rate_max{20, 20};

  template <class T>
  CostTerms<T, 3> stage_cost(const State<T>& x, const Input<T, 2>& u) const {
    const Cost<T> place = place_cost(x);
    return {{distance(x), T(0.1) * u[1] * u[1], select(place.collided, T(100), T(0))}, place.collided};
  }
};

template <class Robot = problems::DifferentialDrive>
void own_problem(benchmark::State& state, simd::Target target) {
  if (!simd::supported(target)) return state.SkipWithError("not supported by this processor");
  Work work;
  const ProblemEvaluator<Robot> evaluator({}, target);
  for (auto _ : state) {
    evaluator.evaluate(work.batch, 0, samples, work.costs.data(), work.collided.data());
    benchmark::ClobberMemory();
  }
  std::vector<Input<double, 2>> u;
  for (int t = 0; t < steps; ++t)
    u.push_back({{static_cast<double>(work.batch.at(t, 0, 0)), static_cast<double>(work.batch.at(t, 1, 0))}});
  hold_input_rates(Robot{}, {}, u.data(), steps);
  const double exact = predict(Robot{}, {0, 0, 0}, u.data(), steps, nullptr).value;
  if (std::abs(static_cast<double>(work.costs[0]) - exact) > 1e-3 * exact)
    state.SkipWithError("a cost is wrong");
  report(state);
}
void with_parts(benchmark::State& state, simd::Target target) {
  own_problem<WithParts>(state, target);
}
BENCHMARK_CAPTURE(own_problem, generic, simd::Target::generic);
#if SLALOM_X86
BENCHMARK_CAPTURE(own_problem, avx2, simd::Target::avx2);
BENCHMARK_CAPTURE(own_problem, avx512, simd::Target::avx512);
BENCHMARK_CAPTURE(with_parts, avx2, simd::Target::avx2);
BENCHMARK_CAPTURE(with_parts, avx512, simd::Target::avx512);

void hand_tuned(benchmark::State& state) {
  if (!simd::supported(simd::Target::avx2)) return state.SkipWithError("not supported by this processor");
  Work work, check;
  for (auto _ : state) {
    hand_tuned_avx2(work.batch, work.costs.data());
    benchmark::ClobberMemory();
  }
  const ProblemEvaluator<problems::DifferentialDrive> evaluator(problems::DifferentialDrive{});
  evaluator.evaluate(check.batch, 0, samples, check.costs.data(), check.collided.data());
  if (std::abs(work.sum() - check.sum()) > 0.01 * check.sum()) state.SkipWithError("the costs differ");
  report(state);
}
BENCHMARK(hand_tuned);
#endif

}  // namespace
}  // namespace slalom
