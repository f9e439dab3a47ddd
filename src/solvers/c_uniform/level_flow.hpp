#pragma once

#include <vector>

namespace slalom::detail {

/// Mass that flows from the cells of a level to those of the next, along the edges that the inputs make.
struct LevelFlow {
  std::vector<double> supply;  ///< mass of each cell, > 0
  std::vector<int> first;    ///< [cell + 1]: its edges are first[cell] ... first[cell + 1] - 1, at least one
  std::vector<int> target;   ///< [edge]: a cell of the next level, each once among the edges of a cell
  std::vector<double> flow;  ///< [edge], >= 0; those of a cell sum to its supply
  std::vector<double> mass;  ///< [target]: what flows into it; each has an edge

  /// Starts with a flow in which a target that many cells reach gets little of each.
  void start();
  /// Makes the masses as even as possible: sweeps over the cells, each of which pours its mass where there is
  /// least, until `gap` is at most `tolerance` times the sum of the squares of the masses. Returns the number
  /// of sweeps, at most `sweeps`.
  int level_out(int sweeps, double tolerance);
  /// The duality gap: half the sum of the squares of the masses is at most this much above its minimum.
  double gap() const;

 private:
  void pour(int cell);

  std::vector<int> order_;  ///< edges of a cell, by the mass of their targets
};

}  // namespace slalom::detail
