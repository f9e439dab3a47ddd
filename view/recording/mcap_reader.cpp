#include "view/recording/mcap_reader.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "view/recording/mcap_bytes.hpp"

namespace slalom::view::mcap {
namespace {

constexpr std::uint64_t head_size = 1 + 8;  // bytes before the content of a record

std::uint32_t crc(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

/// Reads the content of a record from its beginning.
class Reader {
 public:
  Reader(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  template <class T>
  T get() {
    T value{};
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::string text() { return std::string(take(get<std::uint32_t>())); }
  std::string_view take(std::uint64_t count) {
    if (count > bytes_.size()) throw IoError(file_, 0, "is damaged: a record ends too soon");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }

 private:
  std::string_view bytes_;
  const std::string& file_;
};

class File {
 public:
  explicit File(const std::string& name) : name_(name) {
    if (!std::filesystem::is_regular_file(name))
      throw IoError(name, 0, "cannot be read: it must be a regular file");
    stream_.open(name, std::ios::binary | std::ios::ate);
    if (!stream_.is_open()) throw cannot_open(name);
    size_ = static_cast<std::uint64_t>(stream_.tellg());
    if (size_ < magic.size() || read(0, magic.size()) != magic)
      throw IoError(name, 0, "is not an MCAP recording");
  }

  /// Whether the file ends as an MCAP file does: otherwise it was cut.
  bool is_finished() { return read(size_ - magic.size(), magic.size()) == magic; }
  std::uint64_t size() const { return size_; }

  std::string read(std::uint64_t offset, std::uint64_t length) {
    std::string bytes(length, '\0');
    stream_.seekg(static_cast<std::streamoff>(offset));
    if (!stream_.read(bytes.data(), static_cast<std::streamsize>(length)))
      throw IoError(name_, 0, "cannot be read");
    return bytes;
  }

 private:
  std::string name_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
};

/// Reads an attachment from the content of its record.
Attachment parse_attachment(std::string_view content, const std::string& file) {
  Reader reader(content, file);
  reader.take(16);  // the times to which it belongs and at which it was made
  Attachment attachment{.name = reader.text(), .data = {}};
  reader.text();  // its media type
  attachment.data = reader.take(reader.get<std::uint64_t>());
  const auto sum = reader.get<std::uint32_t>();
  if (sum != 0 && crc(content.substr(0, content.size() - 4)) != sum)
    throw IoError(file, 0, "is damaged: " + attachment.name + " has a wrong checksum");
  return attachment;
}

}  // namespace

std::vector<Attachment> read_attachments(const std::string& name, std::string_view prefix,
                                         std::uint64_t* lost) {
  File file(name);
  const bool is_cut = !file.is_finished();
  if (is_cut && !lost) throw IoError(name, 0, "is incomplete: the recording was not finished");
  std::vector<Attachment> found;
  std::uint64_t at = magic.size();
  for (;;) {
    if (file.size() - at < head_size) break;
    const std::string head = file.read(at, head_size);
    Reader reader(head, name);
    const Op op = reader.get<Op>();
    const auto length = reader.get<std::uint64_t>();
    if (op == Op::data_end) {
      at = file.size();
      break;
    }
    if (length > file.size() - at - head_size) break;
    if (op == Op::attachment) {
      try {
        Attachment each = parse_attachment(file.read(at + head_size, length), name);
        if (each.name.starts_with(prefix)) found.push_back(std::move(each));
      } catch (const IoError&) {
        if (is_cut) break;
        throw;
      }
    }
    at += head_size + length;
  }
  if (!is_cut && at < file.size()) throw IoError(name, 0, "is damaged: a record ends too soon");
  if (lost) *lost = is_cut ? file.size() - at : 0;
  return found;
}

}  // namespace slalom::view::mcap
