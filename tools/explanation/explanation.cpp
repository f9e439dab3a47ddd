#include "tools/explanation/explanation.hpp"

#include "slalom/core/problem_evaluator.hpp"
#include "slalom/core/random.hpp"

namespace slalom::tools {
namespace {

using problems::PassingPoint;

/// The way of a sequence whose input at step k is u(k).
template <class Inputs>
Way way_of(const PassingPoint& point, int steps, Inputs u) {
  Way way;
  PassingPoint::State<double> x{0, 0};
  way.push_back(x.y);
  for (int k = 0; k < steps; ++k) {
    x = point.step<double>(x, {{static_cast<double>(u(k))}});
    way.push_back(x.y);
  }
  return way;
}

/// Histogram of the places beside the disc of many samples of the prior, weighted by exp(-S).
void optimal_density(const ProblemEvaluator<PassingPoint>& evaluator, int steps, Explanation& e) {
  constexpr int block = 16384, blocks = 16, bins = 200;
  constexpr double reach = 2;
  SequenceBatch batch(steps, 1, block);
  AlignedBuffer costs(block);
  std::vector<std::uint8_t> collided(block);
  std::vector<std::pair<double, double>> seen;  // place, cost
  for (int b = 0; b < blocks; ++b) {
    fill_normal(batch, 0, block, {0, static_cast<std::uint64_t>(b)});
    evaluator.evaluate(batch, 0, block, costs.data(), collided.data());
    for (int i = 0; i < block; ++i) {
      double place = 0;
      for (int k = 0; k < e.beside; ++k) place += e.point.dt * static_cast<double>(batch.at(k, 0, i));
      seen.emplace_back(place, static_cast<double>(costs[static_cast<std::size_t>(i)]));
    }
  }
  double least = seen[0].second;
  for (const auto& [place, cost] : seen) least = std::min(least, cost);
  std::vector<double> histogram(bins);
  for (const auto& [place, cost] : seen) {
    const int bin = static_cast<int>(std::floor((place + reach) / (2 * reach) * bins));
    if (bin >= 0 && bin < bins) histogram[static_cast<std::size_t>(bin)] += std::exp(least - cost);
  }
  // A little smoothing takes the noise of the histogram away and leaves the modes.
  e.density.assign(bins, 0);
  double area = 0;
  for (int i = 0; i < bins; ++i) {
    e.places.push_back(-reach + (i + 0.5) * 2 * reach / bins);
    double& here = e.density[static_cast<std::size_t>(i)];
    for (int j = std::max(0, i - 5); j < std::min(bins, i + 6); ++j)
      here += histogram[static_cast<std::size_t>(j)] * std::exp(-0.5 * (i - j) * (i - j) / 2.25);
    area += here * 2 * reach / bins;
  }
  for (double& value : e.density) value /= area;
}

void tell_samples(const SolveResult& result, int steps, Explanation& e) {
  const SequenceBatch& values = *result.samples;
  for (int i = 0; i < values.samples(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    e.samples.push_back({way_of(e.point, steps, [&](int k) { return values.at(k, 0, i); }),
                         static_cast<double>(result.costs[at]), static_cast<double>(result.weights[at]),
                         result.collided[at] != 0});
  }
}

void tell_guides(const SolveResult& result, int steps, Explanation& e) {
  const int guides = result.guides.sequences;
  e.guides.resize(static_cast<std::size_t>(guides));
  for (int i = 0; i < result.guide_path.sequences; ++i) {
    const float* sequence = result.guide_path.values.data() + static_cast<std::ptrdiff_t>(i) * steps;
    e.guides[static_cast<std::size_t>(i % guides)].push_back(
        way_of(e.point, steps, [&](int k) { return sequence[k]; }));
  }
  for (int g = 0; g < guides; ++g)
    if (std::equal(result.nominal.begin(), result.nominal.end(), result.guides.values.begin() + g * steps))
      e.best_guide = g;
}

void tell_outcome(const SolveResult& result, int steps, Explanation& e) {
  e.plan = way_of(e.point, steps, [&](int k) { return result.inputs[static_cast<std::size_t>(k)]; });
  e.mean = way_of(e.point, steps, [&](int k) { return result.mean[static_cast<std::size_t>(k)]; });
  double variance = 0;
  e.deviation = {0};
  std::vector<Input<double, 1>> inputs;
  for (std::size_t k = 0; k < static_cast<std::size_t>(steps); ++k) {
    variance += e.point.dt * e.point.dt * static_cast<double>(result.variances[k]);
    e.deviation.push_back(std::sqrt(variance));
    inputs.push_back({{static_cast<double>(result.inputs[k])}});
  }
  e.plan_collides =
      predict(e.point, PassingPoint::State<double>{0, 0}, inputs.data(), steps, nullptr).collided;
  e.effective_samples = result.effective_sample_size;
}

}  // namespace

Explanation explain(SolverOptions options, const std::string& about, std::uint64_t seed) {
  *options.find<int>("horizon") = 20;
  *options.find<PerInput>("variance") = 1;
  *options.find<double>("temperature") = 1;
  *options.find<PerInput>("input_min") = -3;
  *options.find<PerInput>("input_max") = 3;
  const auto solver = make_solver(options, 1);
  solver->reset(seed);
  const int steps = solver->horizon();
  Explanation e{.method = options.method(), .about = about};
  const double way = e.point.speed * e.point.dt;
  e.beside = std::clamp(static_cast<int>(std::lround(e.point.disc_x / way)), 0, steps);
  ProblemEvaluator<PassingPoint> evaluator(e.point);
  evaluator.set_state({0, 0});
  solver->connect(evaluator);
  const SolveResult& result = solver->solve(evaluator, {});
  tell_guides(result, steps, e);
  tell_samples(result, steps, e);
  tell_outcome(result, steps, e);
  optimal_density(evaluator, steps, e);
  return e;
}

}  // namespace slalom::tools
