#pragma once

#include <span>
#include <vector>

#include "slalom/solvers/solver.hpp"
#include "slalom/view/subject.hpp"
#include "view/protocol/frame_writer.hpp"

/// The blocks of a message that describe the scene, and those that follow from a solver's result alone.
namespace slalom::view {

/// Writes a block of lines, if there are any.
void put_lines(FrameWriter& to, Block block, const std::vector<Line>& lines);

/// Writes the body, 0, and the shapes, whose numbers are their indices + 1; polygons apart.
void put_bodies(FrameWriter& to, const Shape& body, const std::vector<Shape>& shapes);

/// Writes the `inputs` of each step: those of the plan, the nominal sequence, and the guide that became most
/// like it, after its first of several steps.
void put_inputs(FrameWriter& to, const SolveResult& solve, std::size_t inputs);

/// Writes the cost of each state by term, [trajectory][point][term], as a byte between the least and the
/// largest value of its trajectory and term.
void put_step_costs(FrameWriter& to, std::span<const double> costs, std::size_t terms, std::size_t points);

/// Writes temperatures around the one in use, and the effective sample size of these costs with each. Writes
/// nothing where the method has no temperature.
void put_effective_samples(FrameWriter& to, const SolveResult& solve);

}  // namespace slalom::view
