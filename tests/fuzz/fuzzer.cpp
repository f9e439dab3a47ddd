// The two functions that libFuzzer calls, for the one target of this program.
//
//   fuzz_NAME CORPUS [options of libFuzzer]
//
// If the folder CORPUS does not exist, it is made, with the target's seeds.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>

#include "fuzz/target.hpp"

using slalom::fuzz::targets;

namespace {

void write_seeds(const std::filesystem::path& corpus) {
  if (std::filesystem::exists(corpus)) return;
  std::filesystem::create_directories(corpus);
  int number = 0;
  for (const std::string& seed : targets().front()->seeds())
    std::ofstream(corpus / ("seed_" + std::to_string(number++)), std::ios::binary) << seed;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  static std::vector<char*> changed(*arguments, *arguments + *count);
  static std::string max_bytes = "-max_len=" + std::to_string(targets().front()->max_bytes());
  if (changed.size() > 1 && changed[1][0] != '-') write_seeds(changed[1]);
  changed.insert(changed.begin() + 1, max_bytes.data());
  *count = static_cast<int>(changed.size());
  changed.push_back(nullptr);
  *arguments = changed.data();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    targets().front()->run({reinterpret_cast<const char*>(data), size});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "finding of %s: %s\n", targets().front()->name(), error.what());
    std::abort();
  }
  return 0;
}
