#include "solvers/c_uniform/level_flow.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace slalom::detail {

void LevelFlow::start() {
  std::fill(mass.begin(), mass.end(), 0.0);
  for (const int to : target) mass[to] += 1;  // the number of cells that reach it
  flow.resize(target.size());
  for (std::size_t cell = 0; cell < supply.size(); ++cell) {
    double sum = 0;
    for (int e = first[cell]; e < first[cell + 1]; ++e) sum += flow[e] = 1 / mass[target[e]];
    for (int e = first[cell]; e < first[cell + 1]; ++e) flow[e] *= supply[cell] / sum;
  }
  std::fill(mass.begin(), mass.end(), 0.0);
  for (std::size_t e = 0; e < target.size(); ++e) mass[target[e]] += flow[e];
}

/// Takes the mass of a cell away and pours it like water: its lowest targets rise to the same level.
void LevelFlow::pour(int cell) {
  const int begin = first[cell], end = first[cell + 1];
  for (int e = begin; e < end; ++e) mass[target[e]] -= flow[e];
  order_.resize(static_cast<std::size_t>(end - begin));
  std::iota(order_.begin(), order_.end(), begin);
  std::sort(order_.begin(), order_.end(), [&](int a, int b) {
    const double left = mass[target[a]], right = mass[target[b]];
    return left < right || (left == right && target[a] < target[b]);
  });
  double level = 0, sum = supply[cell];
  std::size_t wet = 0;
  do {
    sum += mass[target[order_[wet++]]];
    level = sum / static_cast<double>(wet);
  } while (wet < order_.size() && mass[target[order_[wet]]] < level);
  for (std::size_t i = 0; i < order_.size(); ++i) {
    double& here = mass[target[order_[i]]];
    flow[order_[i]] = i < wet ? std::max(level - here, 0.0) : 0.0;
    here += flow[order_[i]];
  }
}

int LevelFlow::level_out(int sweeps, double tolerance) {
  for (int done = 0; done < sweeps; ++done) {
    if (gap() <= tolerance * std::inner_product(mass.begin(), mass.end(), mass.begin(), 0.0)) return done;
    // Forwards and backwards alternately, so that mass moves far in either direction.
    const int cells = static_cast<int>(supply.size());
    for (int i = 0; i < cells; ++i) pour(done % 2 == 0 ? i : cells - 1 - i);
  }
  return sweeps;
}

double LevelFlow::gap() const {
  double gap = 0;
  for (std::size_t cell = 0; cell < supply.size(); ++cell) {
    double lowest = mass[target[first[cell]]], carried = 0;
    for (int e = first[cell]; e < first[cell + 1]; ++e) {
      lowest = std::min(lowest, mass[target[e]]);
      carried += flow[e] * mass[target[e]];
    }
    gap += carried - supply[cell] * lowest;
  }
  return gap;
}

}  // namespace slalom::detail
