#pragma once

#include <filesystem>

namespace slalom::tools {

/// Verifies an evaluation's folder: settings and rows are those that were written, every lap is there once
/// and with its seed, and `again` of the laps, spread over the table, repeat bit for bit. Prints what it
/// found. Returns the exit status: 0 only if all of it holds. Throws IoError that names what is damaged.
int check_evaluation(const std::filesystem::path& folder, int again);

}  // namespace slalom::tools
