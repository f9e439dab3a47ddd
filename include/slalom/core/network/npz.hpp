#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace slalom {

/// An array of a file that `numpy.savez` wrote.
struct NpyArray {
  std::vector<std::int64_t> shape;  ///< length of each dimension; empty for a single value
  std::vector<double> values;       ///< the values, row by row; truth values are 0 and 1; empty for a text
  std::string text;                 ///< the text, if the array is a single one
};

/// The arrays by their names in a file that `numpy.savez` wrote: of float32, float64, truth values, or a
/// single ASCII text. At most 16 MiB and 256 arrays are read, and the checksum of each is compared. Throws
/// IoError that names the array and the rule if a file is anything else, compressed
/// (`numpy.savez_compressed`) or damaged.
std::map<std::string, NpyArray> read_npz(const std::filesystem::path& file);

}  // namespace slalom
