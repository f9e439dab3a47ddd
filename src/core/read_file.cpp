#include "slalom/core/read_file.hpp"

#include <dirent.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <memory>
#include <system_error>

#include "slalom/core/files/write_file.hpp"

namespace slalom {

std::string read_file(const std::filesystem::path& file, std::uint64_t most) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status) || std::filesystem::is_directory(status))
    throw IoError(file.string(), 0, "does not exist or cannot be read");
  if (!std::filesystem::is_regular_file(status))
    throw IoError(file.string(), 0, "must be a regular file, not a pipe or device");
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  if (!stream) throw cannot_open(file);
  const auto size = static_cast<std::uint64_t>(stream.tellg());
  if (size > most) {
    throw IoError(file.string(), 0,
                  "has " + std::to_string(size) + " bytes; at most " + std::to_string(most) + " are read");
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  stream.seekg(0);
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size)))
    throw IoError(file.string(), 0, "does not exist or cannot be read");
  return bytes;
}

void write_file(const std::filesystem::path& file, std::string_view bytes) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary);
  const bool opened = stream.is_open();
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (stream) return;
  const IoError error = cannot_write(file);
  std::error_code ignored;
  if (opened && std::filesystem::is_regular_file(file, ignored)) std::filesystem::remove(file, ignored);
  throw error;
}

IoError cannot_write(const std::filesystem::path& file) {
  return {file.string(), 0, "cannot be written: " + std::generic_category().message(errno ? errno : EIO)};
}

IoError cannot_open(const std::filesystem::path& file) {
  return {file.string(), 0, "cannot be opened: " + std::generic_category().message(errno)};
}

std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder) {
  const auto close = [](DIR* open) { ::closedir(open); };
  const std::unique_ptr<DIR, decltype(close)> open(::opendir(folder.c_str()), close);
  if (!open) throw cannot_open(folder);
  std::vector<std::filesystem::path> found;
  while (const dirent* const entry = ::readdir(open.get())) {
    const std::string_view name = entry->d_name;
    if (name != "." && name != "..") found.push_back(folder / name);
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace slalom
