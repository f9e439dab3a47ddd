#include "view/recording/mcap_reader.hpp"

#include <zlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "slalom/core/error.hpp"
#include "view/recording/mcap_bytes.hpp"

namespace slalom::view::mcap {
namespace {

constexpr std::uint64_t most_summary = std::uint64_t{1} << 26;  // bytes
constexpr std::uint64_t footer_size = 1 + 8 + 20;

/// Reads a record's content from its beginning.
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
    if (count > bytes_.size() - at_) throw IoError(file_, 0, "is damaged: a record ends too soon");
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }
  bool done() const { return at_ == bytes_.size(); }

 private:
  std::string_view bytes_;
  const std::string& file_;
  std::size_t at_ = 0;
};

std::uint32_t crc(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

class File {
 public:
  explicit File(const std::string& name) : name_(name) {
    if (std::filesystem::is_regular_file(name)) stream_.open(name, std::ios::binary | std::ios::ate);
    if (!stream_.is_open()) throw IoError(name, 0, "cannot be read: it must be a regular file");
    size_ = static_cast<std::uint64_t>(stream_.tellg());
    if (size_ < 2 * magic.size() + footer_size || read(0, magic.size()) != magic)
      throw IoError(name, 0, "is not an MCAP recording");
    if (read(size_ - magic.size(), magic.size()) != magic)
      throw IoError(name, 0, "is incomplete: the recording was not finished");
  }

  std::string read(std::uint64_t offset, std::uint64_t length) {
    if (offset > size_ || length > size_ - offset)
      throw IoError(name_, 0, "is damaged: an index points outside the file");
    std::string bytes(length, '\0');
    stream_.seekg(static_cast<std::streamoff>(offset));
    if (!stream_.read(bytes.data(), static_cast<std::streamsize>(length)))
      throw IoError(name_, 0, "cannot be read");
    return bytes;
  }

  /// The summary, its checksum checked.
  std::string summary() {
    const std::uint64_t at = size_ - magic.size() - footer_size;
    const std::string footer = read(at, footer_size);
    Reader reader(footer, name_);
    if (reader.get<std::uint8_t>() != static_cast<std::uint8_t>(Op::footer))
      throw IoError(name_, 0, "is damaged: it has no footer");
    reader.get<std::uint64_t>();
    const auto start = reader.get<std::uint64_t>();
    reader.get<std::uint64_t>();
    const auto sum = reader.get<std::uint32_t>();
    if (start == 0 || start > at) throw IoError(name_, 0, "has no index");
    if (at - start > most_summary)
      throw IoError(name_, 0,
                    "has an index of " + std::to_string(at - start) + " bytes; at most " +
                        std::to_string(most_summary) + " are read");
    const std::string bytes = read(start, at + footer_size - 4 - start);
    if (sum != 0 && crc(bytes) != sum) throw IoError(name_, 0, "is damaged: its index has a wrong checksum");
    return bytes.substr(0, at - start);
  }

  const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
};

Attachment attachment_at(File& file, std::uint64_t offset, std::uint64_t length) {
  const std::string record = file.read(offset, length);
  Reader head(record, file.name());
  if (head.get<std::uint8_t>() != static_cast<std::uint8_t>(Op::attachment))
    throw IoError(file.name(), 0, "is damaged: an index does not point to an attachment");
  const std::string_view content = head.take(head.get<std::uint64_t>());
  Reader reader(content, file.name());
  reader.take(16);  // times
  Attachment attachment;
  attachment.name = reader.text();
  attachment.media_type = reader.text();
  attachment.data = reader.take(reader.get<std::uint64_t>());
  const auto sum = reader.get<std::uint32_t>();
  if (sum != 0 && crc(content.substr(0, content.size() - 4)) != sum)
    throw IoError(file.name(), 0, "is damaged: " + attachment.name + " has a wrong checksum");
  return attachment;
}

}  // namespace

std::vector<Attachment> read_attachments(const std::string& name, std::string_view prefix) {
  File file(name);
  const std::string summary = file.summary();
  std::vector<Attachment> found;
  std::uint64_t end = 0;  // of the attachment before: each is read once, so all fit into the file's size
  for (Reader reader(summary, name); !reader.done();) {
    const auto op = reader.get<std::uint8_t>();
    Reader content(reader.take(reader.get<std::uint64_t>()), name);
    if (op != static_cast<std::uint8_t>(Op::attachment_index)) continue;
    const auto offset = content.get<std::uint64_t>(), length = content.get<std::uint64_t>();
    content.take(24);  // times and size
    if (content.text().compare(0, prefix.size(), prefix) != 0) continue;
    if (offset < end) throw IoError(name, 0, "is damaged: its index repeats an attachment");
    end = offset + length;
    found.push_back(attachment_at(file, offset, length));
  }
  return found;
}

}  // namespace slalom::view::mcap
