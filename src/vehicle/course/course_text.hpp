#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "slalom/maps/pose.hpp"
#include "slalom/vehicle/course/track_generator.hpp"

/// The files of a course as text.
namespace slalom::vehicle::detail {

/// A number with this many decimals, never "-0".
std::string fixed(double value, int digits);

/// Creates a folder and those above it. Throws IoError.
void make_folder(const std::filesystem::path& folder);

/// Writes a file. Throws IoError.
void write_file(const std::filesystem::path& file, const std::string& text);

/// raceline.csv: `# s_m; x_m; ...` and a row a point.
std::string raceline_text(const std::vector<RacelinePoint>& raceline, int digits);

/// course.yaml; `maker` is the command of the program.
std::string course_text(const std::string& maker, const TrackLabel& label, const maps::Pose& start,
                        bool closed);

}  // namespace slalom::vehicle::detail
