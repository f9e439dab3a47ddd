#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slalom/core/final_check.hpp"
#include "slalom/core/options.hpp"
#include "slalom/core/random.hpp"

namespace slalom {

/// Options of a C-Uniform law.
struct CUniformOptions {
  int input_steps = 4;        ///< steps of the horizon for which an input is held, from one level to the next
  PerInput input_values = 5;  ///< values of an input: how many, evenly spaced between its bounds
  int cells = 100000;         ///< most cells of all levels together
  int sweeps = 200;           ///< most sweeps over the cells of a level
};

/// Declares every option by name, help and range.
template <class Options, class Visit>
requires is_options_of<Options, CUniformOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.input_steps, Declaration{.name = "input_steps",
                                   .unit = "steps",
                                   .help = "time for which an input is held, from one level to the next",
                                   .min = 1,
                                   .max = 10000});
  visit(o.input_values, Declaration{.name = "input_values",
                                    .help = "number of values of an input, evenly spaced between its bounds; "
                                            "1: their middle",
                                    .min = 1,
                                    .max = 256});
  visit(o.cells, Declaration{.name = "cells",
                             .help = "most cells of all levels together; bounds memory and time",
                             .min = 2,
                             .max = 1000000});
  visit(o.sweeps, Declaration{.name = "sweeps",
                              .help = "most sweeps over the cells of a level; more make the distribution "
                                      "more uniform",
                              .min = 0,
                              .max = 100000});
}

/// A coordinate of the configuration space, divided into cells.
struct CellAxis {
  double size = 0;  ///< of a cell, > 0, in the unit of the coordinate
  /// After which the coordinate repeats, as 2 pi of a heading; 0: it does not. The size is changed to the
  /// nearest of which a whole number fits.
  double period = 0;
};

/// A system as a C-Uniform law needs it. `CUniform` makes one of a problem struct. Derive from it where the
/// dynamics are not a problem struct.
class CellDynamics {
 public:
  virtual ~CellDynamics() = default;

  /// Writes the state `next` [states] that follows from `x` [states] with the inputs `u` [inputs] of step
  /// `k`. `next` and `x` do not overlap.
  virtual void step(int k, std::span<const double> x, std::span<const double> u, std::span<double> next) = 0;

  /// Writes the `coordinates` [axes] of a state.
  virtual void locate(std::span<const double> x, std::span<double> coordinates) = 0;
};

/// Probabilities of inputs with which the states of a system spread evenly over the cells that they can reach
/// (C-Uniform sampling: O. G. Poyrazoglu, Y. Cao and V. Isler, "C-Uniform Trajectory Sampling For Fast Motion
/// Planning", arXiv 2409.12266, 2024). docs/algorithms/c-uniform.md derives them.
///
/// Level t holds the cells that are reached after t inputs, each with one state in it. Each input leads from
/// a cell to a cell of the next level. The probabilities of the inputs of a cell are such that, of all
/// distributions over the next level that they can make, its distribution is the most even one.
///
/// `CUniform` is this class for a problem struct. Construction allocates: 8 bytes for each cell and
/// combination of input values, and while it lasts about four times as much. Nothing else here allocates, or
/// throws.
class CUniformLaw {
 public:
  /// The law for `horizon` steps, 1 ... 10000, from the state `start`, which is the centre of the first cell.
  /// Throws std::invalid_argument if the horizon, an option, an axis, a bound or the start is out of range,
  /// if there are more than 256 combinations of input values, if the levels have more than `cells` cells, or
  /// if no input leads from a cell to a finite state.
  CUniformLaw(CellDynamics& system, std::span<const double> start, std::span<const CellAxis> axes,
              int horizon, const InputBounds& bounds, const CUniformOptions& options = {});

  int horizon() const noexcept { return horizon_; }  ///< steps
  int inputs() const noexcept { return inputs_; }    ///< of a step
  /// Levels after the start: the number of inputs of a sequence.
  int levels() const noexcept { return static_cast<int>(levels_.size()) - 1; }
  /// The number of choices: combinations of input values.
  int choices() const noexcept { return choices_; }
  /// A choice, [input].
  std::span<const double> choice(int index) const noexcept;
  /// The cells of a level, 0 ... levels().
  int cells(int level) const noexcept { return static_cast<int>(levels_[at(level)].masses.size()); }
  /// The planned probability of each cell of a level.
  std::span<const double> masses(int level) const noexcept { return levels_[at(level)].masses; }
  /// The probability of each choice in a cell of a level below `levels()`; they sum to 1.
  std::span<const float> probabilities(int level, int cell) const noexcept;
  /// The cell of the next level to which a choice leads; -1 if it leads to no finite state.
  int next_cell(int level, int cell, int choice) const noexcept;

  /// Draws a control sequence [horizon][inputs], which is within the bounds.
  void draw(RandomStream& random, std::span<double> sequence) const noexcept;

 private:
  struct Level {
    std::vector<double> masses;        ///< [cell]
    std::vector<int> next;             ///< [cell][choice]; empty in the last level
    std::vector<float> probabilities;  ///< [cell][choice]; empty in the last level
  };
  class Builder;

  static std::size_t at(int index) noexcept { return static_cast<std::size_t>(index); }
  std::size_t place(int cell, int choice) const noexcept { return at(cell) * at(choices_) + at(choice); }

  int horizon_;
  int inputs_;
  int input_steps_;
  int choices_ = 1;
  std::vector<double> values_;  ///< [choice][input]
  std::vector<Level> levels_;   ///< [level]
};

}  // namespace slalom
