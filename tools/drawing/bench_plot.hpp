#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace slalom::tools {

/// A curve of solve times over the number of samples.
struct BenchCurve {
  std::string name;
  std::vector<double> samples, milliseconds;
};

/// Writes a picture of the curves, both axes logarithmic. Throws IoError.
void plot_bench(const std::vector<BenchCurve>& curves, const std::string& title,
                const std::filesystem::path& file);

}  // namespace slalom::tools
