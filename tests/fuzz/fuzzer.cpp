// The two functions that libFuzzer calls.
//
//   fuzzer targets                            prints the names of the targets
//   fuzzer TARGET CORPUS [options of libFuzzer]
//
// If the folder CORPUS does not exist, it is made, with the target's seeds.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>

#include "fuzz/target.hpp"

namespace {

const slalom::fuzz::Target* target = nullptr;

void write_seeds(const std::filesystem::path& corpus) {
  if (std::filesystem::exists(corpus)) return;
  std::filesystem::create_directories(corpus);
  int number = 0;
  for (const std::string& seed : target->seeds())
    std::ofstream(corpus / ("seed_" + std::to_string(number++)), std::ios::binary) << seed;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  static std::vector<char*> changed(*arguments, *arguments + *count);
  const std::string name = *count > 1 ? changed[1] : "";
  for (const slalom::fuzz::Target* each : slalom::fuzz::targets()) {
    if (name == "targets") std::puts(each->name);
    if (name == each->name) target = each;
  }
  if (target == nullptr) std::exit(name == "targets" ? 0 : 2);
  static std::string max_bytes = "-max_len=" + std::to_string(target->max_bytes);
  if (*count > 2 && changed[2][0] != '-') write_seeds(changed[2]);
  changed[1] = max_bytes.data();
  changed.push_back(nullptr);
  *arguments = changed.data();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    target->run({reinterpret_cast<const char*>(data), size});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "finding of %s: %s\n", target->name, error.what());
    std::abort();
  }
  return 0;
}
