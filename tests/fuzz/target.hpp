#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "slalom/core/error.hpp"
#include "support/promise.hpp"
#include "support/temporary_folder.hpp"

/// Fuzz targets: each hands bytes to a part of Slalom that takes something from outside, and checks the
/// result. All targets are compiled twice: into a fuzzer (libFuzzer), and into `fuzz_test`, which needs no
/// clang and replays seeds, changed seeds and earlier findings.
namespace slalom::fuzz {

using testing::require;
using Seeds = std::vector<std::string>;

/// Calls `read` and returns whether it accepts its input: it throws no IoError.
template <class Read>
bool is_valid(Read&& read) {
  try {
    read();
    return true;
  } catch (const IoError&) {
    return false;
  }
}

/// A target; it registers itself.
struct Target {
  Target(const char* target_name, std::size_t longest, Seeds (*make_seeds)(),
         bool (*take_bytes)(std::string_view bytes), int most_calls = 4);
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  /// Takes an input and returns whether it is valid. Throws if the part under test breaks its promise, or
  /// throws an error that it does not document.
  bool run(std::string_view bytes) const;

  const char* name;
  std::size_t max_bytes;  ///< bytes of the longest input that a fuzzer makes
  Seeds (*seeds)();  ///< makes inputs, with the writers of Slalom where there are any; the first is valid
  int calls;         ///< most calls for an input, each within testing::CallLimits
  bool (*take)(std::string_view bytes);  ///< as `run`, and may throw IoError for an input that is not valid
};

/// All targets.
std::vector<const Target*>& targets();

/// `count` texts of `size` random bytes, the same at every call; `first` in place of the first if given.
Seeds random_bytes(int count, std::size_t size, std::string_view first = {});

/// The folder of this process for files of targets.
const testing::ScopedFolder& scratch_folder();

/// Writes a file in the scratch folder; returns its path.
std::string scratch_file(const std::string& name, std::string_view bytes);

/// The byte between the texts of an input that stands for several: the separator of records in ASCII.
inline constexpr char separator = '\x1e';

/// The first `count` texts of an input; those that it lacks are empty.
template <std::size_t count>
std::array<std::string_view, count> split(std::string_view bytes) {
  std::array<std::string_view, count> parts;
  for (std::string_view& part : parts) {
    const std::size_t end = bytes.find(separator);
    part = bytes.substr(0, end);
    bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
  }
  return parts;
}

}  // namespace slalom::fuzz
