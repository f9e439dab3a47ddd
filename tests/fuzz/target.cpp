#include "fuzz/target.hpp"

namespace slalom::fuzz {
namespace {

std::vector<const Target*>& all_targets() {
  static std::vector<const Target*> all;
  return all;
}

}  // namespace

Target::Target(const char* target_name, std::size_t longest, Seeds (*make_seeds)(),
               bool (*take_bytes)(std::string_view bytes))
    : name(target_name), max_bytes(longest), seeds(make_seeds), take(take_bytes) {
  all_targets().push_back(this);
}

bool Target::run(std::string_view bytes) const {
  bool accepted = false;
  return is_valid([&] { accepted = take(bytes); }) && accepted;
}

const std::vector<const Target*>& targets() {
  return all_targets();
}

const testing::ScopedFolder& scratch_folder() {
  static const testing::ScopedFolder folder;
  return folder;
}

std::string scratch_file(const std::string& name, std::string_view bytes) {
  return scratch_folder().write(name, std::string(bytes)).string();
}

}  // namespace slalom::fuzz
