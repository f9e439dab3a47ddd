#include "tools/explanation/explanation.hpp"

#include <algorithm>
#include <cmath>

#include "slalom/core/problem_evaluator.hpp"
#include "slalom/core/random.hpp"
#include "slalom/solvers/cem_options.hpp"
#include "slalom/solvers/dial_mpc_options.hpp"
#include "slalom/solvers/icem_options.hpp"
#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/reverse_mppi_options.hpp"
#include "slalom/solvers/sv_mpc_options.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"

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

/// Variance of the samples of a method at the start, and its temperature; `cem` has none and gets mppi's.
struct Prior {
  double variance = 1, temperature = 1;
};
Prior prior_of(const SolverOptions& options) {
  Prior prior;
  if (const auto* variance = options.find<PerInput>("variance")) prior.variance = (*variance)[0];
  const auto* temperature = options.find<double>("temperature");
  if (temperature) prior.temperature = *temperature;
  return prior;
}

/// The paper's closed form, with one batch of white noise.
SvgMppiOptions closed_form() {
  SvgMppiOptions o;
  o.batches = 1;
  o.guides.count = 4;
  o.guides.iterations = 10;
  o.guides.step = 0.125;
  o.guides.variance = o.guides.restart_variance = o.variance_max = 1;
  o.guides.gradient_samples = 25;
  o.guides.gradient_variance = 0.25;
  o.guides.gradient_temperature = 1;
  o.variance_min = 0.01;
  o.noise = {};
  return o;
}

/// Histogram of the places beside the disc of many samples of the prior, weighted by exp(-S / lambda).
void optimal_density(const ProblemEvaluator<PassingPoint>& evaluator, int steps, const Prior& prior,
                     Explanation& e) {
  constexpr int block = 16384, blocks = 16, bins = 200;
  constexpr double reach = 2;
  SequenceBatch batch(steps, 1, block);
  AlignedBuffer costs(block);
  std::vector<std::uint8_t> collided(block);
  std::vector<std::pair<double, double>> seen;  // place, cost
  const float deviation = static_cast<float>(std::sqrt(prior.variance));
  for (int b = 0; b < blocks; ++b) {
    fill_normal(batch, 0, block, {0, static_cast<std::uint64_t>(b)});
    for (int k = 0; k < steps; ++k) {
      for (int i = 0; i < block; ++i) batch.at(k, 0, i) *= deviation;
    }
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
    if (bin >= 0 && bin < bins)
      histogram[static_cast<std::size_t>(bin)] += std::exp((least - cost) / prior.temperature);
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
  e.status = name(result.status);
  if (result.suspicion != Symptom::no_progress) e.symptom = result.suspicion;
  e.plan = way_of(e.point, steps, [&](int k) { return result.inputs[static_cast<std::size_t>(k)]; });
  e.mean = way_of(e.point, steps, [&](int k) { return result.mean[static_cast<std::size_t>(k)]; });
  double variance = 0;
  e.deviation = {0};
  std::vector<Input<double, 1>> inputs;
  for (std::size_t k = 0; k < static_cast<std::size_t>(steps); ++k) {
    variance += e.point.dt * e.point.dt * static_cast<double>(result.variances[k]);
    e.deviation.push_back(std::sqrt(variance));
    e.inputs.push_back(static_cast<double>(result.inputs[k]));
    inputs.push_back({{e.inputs.back()}});
  }
  const Cost<double> cost =
      predict(e.point, PassingPoint::State<double>{0, 0}, inputs.data(), steps, nullptr);
  e.plan_cost = cost.value;
  e.plan_collides = cost.collided;
  e.effective_samples = result.effective_sample_size;
}

}  // namespace

std::vector<ExplainedMethod> explained_methods() {
  SvgMppiOptions nominal = closed_form(), covariance = closed_form();
  nominal.adapt_covariance = covariance.use_nominal = false;
  std::vector<ExplainedMethod> methods = {
      {"mppi", "forward KL, in closed form", MppiOptions{.control_cost_discount = 0}},
      {"svg_mppi", "guides find a mode, MPPI solves near it", closed_form()},
      {"svg_mppi_nominal", "the guide as nominal alone (NS)", nominal},
      {"svg_mppi_covariance", "the fitted covariance alone (AC)", covariance},
      {"reverse_mppi", "reverse KL, by mirror descent", ReverseMppiOptions{}},
      {"sv_mpc", "particles, moved by SVGD", SvMpcOptions{}},
      {"cem", "refitted to the best samples", CemOptions{}},
      {"icem", "smooth noise, remembers the best samples", IcemOptions{}},
      {"dial_mpc", "updates of MPPI with shrinking noise", DialMpcOptions{}}};
  for (const char* name : solver_names()) {  // methods that were registered beside those of the library
    const bool known =
        std::any_of(methods.begin(), methods.end(), [&](const ExplainedMethod& m) { return m.name == name; });
    if (!known) methods.push_back({name, "", solver_options(name)});
  }
  for (ExplainedMethod& method : methods) {
    *method.options.find<int>("horizon") = 20;
    *method.options.find<PerInput>("variance") = 1;
    if (double* const temperature = method.options.find<double>("temperature")) *temperature = 1;
    *method.options.find<PerInput>("input_min") = -3;
    *method.options.find<PerInput>("input_max") = 3;
  }
  return methods;
}

Explanation explain(const ExplainedMethod& method, const PassingPoint& point, int solves,
                    std::uint64_t seed) {
  Explanation e;
  e.method = method.name;
  e.about = method.about;
  e.point = point;
  e.solves = solves;
  const auto solver = make_solver(method.options, 1);
  solver->reset(seed);
  const int steps = solver->horizon();
  e.beside = std::clamp(static_cast<int>(std::lround(point.disc_x / (point.speed * point.dt))), 0, steps);
  ProblemEvaluator<PassingPoint> evaluator(point);
  evaluator.set_state({0, 0});
  solver->connect(evaluator);
  const SolveResult* result = nullptr;
  for (int i = 0; i < solves; ++i) {
    result = &solver->solve(evaluator, {});
    tell_guides(*result, steps, e);
  }
  tell_samples(*result, steps, e);
  tell_outcome(*result, steps, e);
  const Prior prior = prior_of(method.options);
  e.temperature = prior.temperature;
  optimal_density(evaluator, steps, prior, e);
  return e;
}

}  // namespace slalom::tools
