#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "slalom/evaluation/evaluation.hpp"

/// The text of progress bars, which fits the width of the terminal.
namespace slalom::tools {

/// Columns of the terminal behind a stream; 80 if there is none.
int terminal_columns(std::FILE* stream);
/// Whether a stream is a terminal on which colour is wanted: NO_COLOR is not set, and TERM is not dumb.
bool has_colour(std::FILE* stream);

/// A bar of `width` characters between brackets, of which the share `progress` in [0, 1] is full; in green if
/// `colour`.
std::string progress_bar(double progress, int width, bool colour);

/// The state of an evaluation in at most `columns - 1` characters: title, bar, laps, time left. Until the
/// first lap is finished there is no estimate of the time left, and after the last lap none is needed.
std::string evaluation_text(const std::string& title, const evaluation::EvaluationProgress& progress,
                            int columns, bool colour);

/// The state of a lap in at most `columns - 1` characters: the name of the lap, a bar, and as many of `parts`
/// as there is room for, the first ones first.
std::string lap_text(const std::string& lap, double progress, const std::vector<std::string>& parts,
                     int columns, bool colour);

}  // namespace slalom::tools
