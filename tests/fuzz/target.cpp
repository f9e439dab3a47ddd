#include "fuzz/target.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace slalom::fuzz {
namespace {

std::vector<const Target*>& all_targets() {
  static std::vector<const Target*> all;
  return all;
}

/// A folder that is removed with its files when the process ends.
struct Folder {
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::string path =
      std::filesystem::temp_directory_path() / ("slalom_fuzz_" + std::to_string(::getpid()));
};

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

const std::string& scratch_folder() {
  static const Folder folder;
  return folder.path;
}

std::string scratch_file(const std::string& name, std::string_view bytes) {
  const std::string file = scratch_folder() + "/" + name;
  std::ofstream stream(file, std::ios::binary);
  stream << bytes;
  stream.close();
  if (!stream) throw std::runtime_error(file + ": cannot be written");
  return file;
}

}  // namespace slalom::fuzz
