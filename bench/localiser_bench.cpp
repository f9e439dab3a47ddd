// Localisation with 4000 particles and 60 beams; the number of particles is constant.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

#include "slalom/core/instruction_set.hpp"
#include "vehicle/localiser_drive.hpp"

namespace slalom::vehicle {
namespace {

using test::Drive;
using test::error_of;
using test::Place;

struct Seen {
  std::vector<float> ranges;
  LocaliserInput input;
  maps::Pose truth;
};

/// Ten seconds of driving, recorded beforehand.
std::vector<Seen> record(const Place& place) {
  Drive drive(place, place.at(0.1), 1);
  std::vector<Seen> seen;
  for (int i = 0; i < 400; ++i, drive.step()) {
    const LocaliserInput input = drive.input();
    seen.push_back({{input.scan.ranges.begin(), input.scan.ranges.end()}, input, drive.truth()});
  }
  for (Seen& s : seen) s.input.scan.ranges = s.ranges;
  return seen;
}

/// `adaptive`: the number of particles depends on their spread.
void update(benchmark::State& state, SensorModel model, bool adaptive) {
  const Place place("wren");
  const std::vector<Seen> seen = record(place);
  LocaliserOptions options{.sensor_model = model};
  if (!adaptive) options.min_particles = options.max_particles;
  Localiser localiser(place.course.map, options);
  std::size_t i = 0;
  std::vector<double> times, errors;
  double particles = 0;
  for (auto _ : state) {
    if (i == 0) localiser.start_at(seen[0].truth);
    const LocaliserOutput& out = localiser.update(seen[i].input);
    times.push_back(out.update_time);
    errors.push_back(error_of(out.pose, seen[i].truth).distance);
    particles += out.particles;
    if (out.beams < 55 || (!adaptive && out.particles != options.max_particles))
      state.SkipWithError("too little work");
    i = (i + 1) % seen.size();
  }
  std::sort(times.begin(), times.end());
  std::sort(errors.begin(), errors.end());
  if (errors[errors.size() / 2] > 0.2) state.SkipWithError("not localised");
  double sum = 0;
  for (const double error : errors) sum += error;
  state.counters["particles"] = particles / static_cast<double>(times.size());
  state.counters["p50_ms"] = 1e3 * times[times.size() / 2];
  state.counters["p99_ms"] = 1e3 * times[times.size() * 99 / 100];
  state.counters["error_mean_m"] = sum / static_cast<double>(errors.size());
  state.counters["error_p99_m"] = errors[errors.size() * 99 / 100];
  state.SetLabel(simd::name(simd::active_target()));
}
BENCHMARK_CAPTURE(update, likelihood_field_4000, SensorModel::likelihood_field, false)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(update, beam_4000, SensorModel::beam, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(update, likelihood_field_adaptive, SensorModel::likelihood_field, true)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(update, beam_adaptive, SensorModel::beam, true)->Unit(benchmark::kMillisecond);

void construct(benchmark::State& state, SensorModel model) {
  const Place place("wren");
  for (auto _ : state) {
    Localiser localiser(place.course.map, {.sensor_model = model});
    benchmark::DoNotOptimize(localiser.particle_count());
  }
}
BENCHMARK_CAPTURE(construct, likelihood_field, SensorModel::likelihood_field)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(construct, beam, SensorModel::beam)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace slalom::vehicle
