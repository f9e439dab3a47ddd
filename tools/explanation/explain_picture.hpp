#pragma once

#include "tools/drawing/drawing.hpp"
#include "tools/explanation/explanation.hpp"

namespace slalom::tools {

/// Draws a method: the samples, guides, plan and distribution in space, and beside them, on the same axis,
/// the distribution of the place where the point passes the disc, that of the method and the optimal one.
Drawing draw_explanation(const Explanation& explanation, const std::string& title);

/// Draws the title of a picture, in a size that fits into the width.
void draw_title(Pen& pen, double left, double width, const std::string& title);

/// A figure of the paper of Honda et al. (ICRA 2024), computed for the point that passes a disc: 1, the mean
/// of MPPI hits the disc; 3, the minimisers of the forward and the reverse KL divergence; 4, the parts of
/// SVG-MPPI, with the fit of equation (13).
Drawing draw_paper_figure(int number, std::uint64_t seed);

}  // namespace slalom::tools
