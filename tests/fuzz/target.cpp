#include "fuzz/target.hpp"

#include <random>

#include "support/promise.hpp"

namespace slalom::fuzz {

std::vector<const Target*>& targets() {
  static std::vector<const Target*> all;
  return all;
}

Target::Target(const char* target_name, std::size_t longest, Seeds (*make_seeds)(),
               bool (*take_bytes)(std::string_view bytes), int most_calls)
    : name(target_name), max_bytes(longest), seeds(make_seeds), calls(most_calls), take(take_bytes) {
  targets().push_back(this);
}

bool Target::run(std::string_view bytes) const {
  const testing::CallLimits limits;
  bool accepted = false;
  const bool valid = is_valid([&] { accepted = take(bytes); }) && accepted;
  limits.check(calls);
  return valid;
}

Seeds random_bytes(int count, std::size_t size, std::string_view first) {
  std::mt19937_64 random(1);
  Seeds all(count, std::string(size, '\0'));
  for (std::string& each : all)
    for (char& byte : each) byte = static_cast<char>(random() & 255u);
  if (!first.empty()) all.front() = first;
  return all;
}

const testing::ScopedFolder& scratch_folder() {
  static const testing::ScopedFolder folder;
  return folder;
}

std::string scratch_file(const std::string& name, std::string_view bytes) {
  return scratch_folder().write(name, std::string(bytes)).string();
}

}  // namespace slalom::fuzz
