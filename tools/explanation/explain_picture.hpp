#pragma once

#include <vector>

#include "tools/drawing/drawing.hpp"
#include "tools/explanation/explanation.hpp"

namespace slalom::tools {

/// Methods side by side: the samples, guides, plan and distribution in space, and beside them, on the same
/// axis, the distribution of the place where the point passes the disc, that of the method and the optimal
/// one.
Drawing draw_explanations(const std::vector<Explanation>& explanations);

}  // namespace slalom::tools
