#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "support/promise.hpp"

/// Fuzz targets: each hands bytes to a part of Slalom that takes something from outside, and checks what
/// comes back. A target is compiled twice: into a fuzzer (libFuzzer), and into `fuzz_test`, which needs no
/// clang and replays seeds, changed seeds and earlier findings.
namespace slalom::fuzz {

/// A target; it registers itself.
class Target {
 public:
  using Seeds = std::vector<std::string> (*)();
  using Run = bool (*)(std::string_view bytes);

  /// `longest`: bytes of an input that a fuzzer makes. `make_seeds` makes valid inputs, with the writers of
  /// Slalom where there are any. `take` throws if the part under test breaks its promise, or throws what it
  /// does not document; it returns whether the input was valid. The first seed is.
  Target(const char* target_name, std::size_t longest, Seeds make_seeds, Run take);
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  const char* name() const noexcept { return name_; }
  std::size_t max_bytes() const noexcept { return max_bytes_; }
  std::vector<std::string> seeds() const { return seeds_(); }
  bool run(std::string_view bytes) const { return run_(bytes); }

 private:
  const char* name_;
  std::size_t max_bytes_;
  Seeds seeds_;
  Run run_;
};

/// The targets of this program.
const std::vector<const Target*>& targets();

using testing::require;

/// The folder of this process for files of targets.
const std::string& scratch_folder();

/// Writes a file in the scratch folder; its path.
std::string scratch_file(const std::string& name, std::string_view bytes);

/// An input that stands for several texts has this byte between them: the separator of records in ASCII.
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
