#include "view/protocol/blocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "slalom/core/math.hpp"

namespace slalom::view {
namespace {

constexpr int octaves = 6;  // above and below the temperature in use

/// The position after its first step of the guide that ends nearest to the nominal sequence; empty if there
/// is none, or it made only one step.
std::span<const float> guide_before(const SolveResult& solve) {
  const std::size_t size = solve.nominal.size();
  const auto guides = static_cast<std::size_t>(solve.guides.sequences);
  if (guides == 0 || solve.guide_path.sequences <= solve.guides.sequences ||
      solve.guides.values.size() != guides * size)
    return {};
  const auto distance = [&](std::size_t guide) {
    double sum = 0;
    for (std::size_t i = 0; i < size; ++i)
      sum += square(static_cast<double>(solve.guides.values[guide * size + i] - solve.nominal[i]));
    return sum;
  };
  std::size_t best = 0;
  for (std::size_t guide = 1; guide < guides; ++guide)
    if (distance(guide) < distance(best)) best = guide;
  return solve.guide_path.values.subspan(best * size, size);
}

/// The effective sample size of costs, the least of which is `least`, at a temperature.
double effective_samples(std::span<const float> costs, float least, double temperature) {
  const auto rate = static_cast<float>(-1 / temperature);
  double sum = 0, squares = 0;
  for (const float cost : costs) {
    if (!std::isfinite(cost)) continue;
    const auto weight = static_cast<double>(std::exp(rate * (cost - least)));
    sum += weight;
    squares += weight * weight;
  }
  return squares > 0 ? sum * sum / squares : 0;
}

}  // namespace

void put_inputs(FrameWriter& to, const SolveResult& solve, std::size_t inputs) {
  const std::span<const float> plan = solve.inputs;
  to.begin(Block::inputs);
  to.put(static_cast<std::uint16_t>(plan.size() / inputs));
  to.put(static_cast<std::uint16_t>(inputs));
  for (const auto& sequence : {plan, solve.nominal, guide_before(solve)})
    if (sequence.size() == plan.size())
      for (const float value : sequence) to.put(value);
  to.end();
}

void put_step_costs(FrameWriter& to, std::span<const double> costs, std::size_t terms, std::size_t points) {
  to.begin(Block::step_costs);
  to.put(static_cast<std::uint16_t>(terms));
  to.put(static_cast<std::uint16_t>(points));
  const std::size_t size = points * terms;
  for (std::size_t from = 0; size > 0 && from + size <= costs.size(); from += size)
    for (std::size_t term = from; term < from + terms; ++term) {
      double low = costs[term], high = low;
      for (std::size_t k = 0; k < points; ++k) {
        low = std::min(low, costs[term + k * terms]);
        high = std::max(high, costs[term + k * terms]);
      }
      to.put_f32({low, high});
      for (std::size_t k = 0; k < points; ++k) {
        const double share = high > low ? (costs[term + k * terms] - low) / (high - low) : 0;
        to.put(static_cast<std::uint8_t>(share > 0 ? std::lround(255 * std::min(share, 1.0)) : 0));
      }
    }
  to.end();
}

void put_effective_samples(FrameWriter& to, const SolveResult& solve) {
  if (!(solve.temperature > 0) || solve.costs.empty()) return;
  float least = std::numeric_limits<float>::infinity();
  for (const float cost : solve.costs) least = std::min(least, cost);
  if (!std::isfinite(least)) return;
  to.begin(Block::effective_samples);
  for (int i = -octaves; i <= octaves; ++i) {
    const double temperature = std::ldexp(solve.temperature, i);
    to.put_f32({temperature, effective_samples(solve.costs, least, temperature)});
  }
  to.end();
}

}  // namespace slalom::view
