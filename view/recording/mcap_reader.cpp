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

constexpr std::uint64_t max_record = std::uint64_t{1} << 30;   // bytes
constexpr std::uint64_t max_summary = std::uint64_t{1} << 26;  // bytes
constexpr std::uint64_t footer_size = 1 + 8 + 20;

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
  bool done() const { return bytes_.empty(); }

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

  /// Whether the file has an end: otherwise it was cut.
  bool finished() {
    return size_ >= 2 * magic.size() + footer_size && read(size_ - magic.size(), magic.size()) == magic;
  }
  std::uint64_t size() const { return size_; }

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
    if (reader.get<Op>() != Op::footer) throw IoError(name_, 0, "is damaged: it has no footer");
    reader.get<std::uint64_t>();
    const auto start = reader.get<std::uint64_t>();
    reader.get<std::uint64_t>();
    const auto sum = reader.get<std::uint32_t>();
    if (start == 0 || start > at) throw IoError(name_, 0, "has no index");
    if (at - start > max_summary)
      throw IoError(name_, 0,
                    "has an index of " + std::to_string(at - start) + " bytes; at most " +
                        std::to_string(max_summary) + " are read");
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

/// An attachment from the content of its record.
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

/// The attachments that the index at the end of a file lists.
std::vector<Attachment> indexed_attachments(File& file, std::string_view prefix) {
  const std::string summary = file.summary();
  std::vector<Attachment> found;
  std::uint64_t end = 0;  // end of the attachment before: none is read twice
  for (Reader reader(summary, file.name()); !reader.done();) {
    const auto op = reader.get<Op>();
    Reader content(reader.take(reader.get<std::uint64_t>()), file.name());
    if (op != Op::attachment_index) continue;
    const auto offset = content.get<std::uint64_t>(), length = content.get<std::uint64_t>();
    content.take(24);  // times and size
    if (!content.text().starts_with(prefix)) continue;
    if (offset < end) throw IoError(file.name(), 0, "is damaged: its index repeats an attachment");
    end = offset + length;
    const std::string record = file.read(offset, length);
    Reader head(record, file.name());
    if (head.get<Op>() != Op::attachment)
      throw IoError(file.name(), 0, "is damaged: an index does not point to an attachment");
    found.push_back(parse_attachment(head.take(head.get<std::uint64_t>()), file.name()));
  }
  return found;
}

/// The attachments of a file that was cut, up to its last whole record.
std::vector<Attachment> whole_attachments(File& file, std::string_view prefix, std::uint64_t& lost) {
  constexpr std::uint64_t head = 1 + 8;
  std::vector<Attachment> found;
  std::uint64_t at = magic.size();
  while (file.size() - at >= head) {
    const std::string bytes = file.read(at, head);
    Reader reader(bytes, file.name());
    const Op op = reader.get<Op>();
    const auto length = reader.get<std::uint64_t>();
    if (op == Op::data_end) return found;
    if (length > std::min(max_record, file.size() - at - head)) break;
    if (op == Op::attachment) {
      try {
        Attachment each = parse_attachment(file.read(at + head, length), file.name());
        if (each.name.starts_with(prefix)) found.push_back(std::move(each));
      } catch (const IoError&) {
        break;  // damaged
      }
    }
    at += head + length;
  }
  lost = file.size() - at;
  return found;
}

}  // namespace

std::vector<Attachment> read_attachments(const std::string& name, std::string_view prefix,
                                         std::uint64_t* lost) {
  File file(name);
  if (lost) *lost = 0;
  if (file.finished()) return indexed_attachments(file, prefix);
  if (!lost) throw IoError(name, 0, "is incomplete: the recording was not finished");
  return whole_attachments(file, prefix, *lost);
}

}  // namespace slalom::view::mcap
