#include "slalom/view/drawn_solve.hpp"

#include <algorithm>

namespace slalom::view {

void DrawnSolve::take(const SolveResult& from, bool draws_spread) {
  figures = from;
  figures.inputs = figures.nominal = figures.mean = figures.variances = figures.costs = figures.weights = {};
  figures.samples = nullptr;
  figures.collided = {};
  figures.guides = figures.guide_path = {};
  length = from.inputs.size();
  samples = from.samples ? from.samples->samples() : 0;
  candidates = guides = 0;
  sequences.clear();
  variances.assign(from.variances.begin(), from.variances.end());
  if (length == 0) return;
  add(from.inputs);
  add(from.nominal.size() == length ? from.nominal : from.inputs);
  add_candidates(from);
  const SequenceList& path = from.guide_path.sequences > 0 ? from.guide_path : from.guides;
  guides = static_cast<std::size_t>(path.sequences);
  guides_at_once = static_cast<std::size_t>(std::max(1, from.guides.sequences));
  add(path.values);
  if (!draws_spread || variances.size() != length) return;
  for (std::size_t i = 0; i < length; ++i) {
    add(from.inputs);
    sequences[sequences.size() - length + i] += nudge;
  }
}

/// Adds samples that are evenly spread over the batch, so that the picture is as dense in every region.
void DrawnSolve::add_candidates(const SolveResult& from) {
  constexpr std::size_t most = 160, least = 20, most_points = 50000;  // number in all candidates
  const SequenceBatch* const batch = from.samples;
  if (!batch || from.costs.empty()) return;
  const auto all = static_cast<std::size_t>(samples);
  const std::size_t points = static_cast<std::size_t>(batch->steps()) + 1;
  candidates = std::min(std::clamp(most_points / points, least, most), all);
  costs.resize(candidates);
  weights.resize(candidates);
  collided.resize(candidates);
  for (std::size_t i = 0; i < candidates; ++i) {
    const std::size_t k = i * all / candidates;
    costs[i] = from.costs[k];
    weights[i] = k < from.weights.size() ? from.weights[k] : 0;
    collided[i] = from.collided[k] != 0;
    sequences.resize(sequences.size() + length);
    batch->get_sample(static_cast<int>(k), std::span(sequences).last(length));
  }
}

}  // namespace slalom::view
