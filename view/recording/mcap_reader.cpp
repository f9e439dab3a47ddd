#include "view/recording/mcap_reader.hpp"

#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"

namespace slalom::view::mcap {
namespace {

constexpr std::uint64_t max_record = std::uint64_t{1} << 30;   // bytes
constexpr std::uint64_t max_summary = std::uint64_t{1} << 26;  // bytes
constexpr std::uint64_t footer_size = 1 + 8 + 20;

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
    if (reader.get<std::uint8_t>() != static_cast<std::uint8_t>(Op::footer))
      throw IoError(name_, 0, "is damaged: it has no footer");
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

Attachment attachment_at(File& file, std::uint64_t offset, std::uint64_t length) {
  const std::string record = file.read(offset, length);
  Reader head(record, file.name());
  if (head.get<std::uint8_t>() != static_cast<std::uint8_t>(Op::attachment))
    throw IoError(file.name(), 0, "is damaged: an index does not point to an attachment");
  return parse_attachment(head.take(head.get<std::uint64_t>()), file.name());
}

/// The records of a file, one after another, without any index.
class Records {
 public:
  explicit Records(File& file) : file_(file) {}

  /// Reads the next record; false if it is not whole.
  bool next() {
    constexpr std::uint64_t head = 1 + 8;
    if (file_.size() - at_ < head) return false;
    const std::string bytes = file_.read(at_, head);
    Reader reader(bytes, file_.name());
    op_ = static_cast<Op>(reader.get<std::uint8_t>());
    const auto length = reader.get<std::uint64_t>();
    if (length > std::min(max_record, file_.size() - at_ - head)) return false;
    content_ = file_.read(at_ + head, length);
    at_ += head + length;
    return true;
  }
  Op op() const { return op_; }
  std::string_view content() const { return content_; }
  std::uint64_t at() const { return at_; }

 private:
  File& file_;
  std::uint64_t at_ = magic.size();
  Op op_ = Op::header;
  std::string content_;
};

}  // namespace

std::uint32_t crc(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

Attachment parse_attachment(std::string_view content, const std::string& file) {
  Reader reader(content, file);
  Attachment attachment;
  attachment.time = reader.get<std::uint64_t>();
  reader.get<std::uint64_t>();  // when it was made
  attachment.name = reader.text();
  attachment.media_type = reader.text();
  attachment.data = reader.take(reader.get<std::uint64_t>());
  const auto sum = reader.get<std::uint32_t>();
  if (sum != 0 && crc(content.substr(0, content.size() - 4)) != sum)
    throw IoError(file, 0, "is damaged: " + attachment.name + " has a wrong checksum");
  return attachment;
}

std::uint64_t scan(const std::string& name, const std::function<void(Op, std::string_view)>& take) {
  File file(name);
  std::uint64_t whole = magic.size();
  try {
    for (Records records(file); records.next(); whole = records.at()) {
      if (records.op() == Op::data_end) return 0;
      take(records.op(), records.content());
    }
  } catch (const IoError&) {
    if (whole == magic.size()) throw;  // not even a header
  }
  return file.size() - whole;
}

std::vector<Attachment> read_attachments(const std::string& name, std::string_view prefix,
                                         std::uint64_t* lost) {
  File file(name);
  if (lost) *lost = 0;
  if (!file.finished()) {
    if (!lost) throw IoError(name, 0, "is incomplete: the recording was not finished");
    std::vector<Attachment> found;
    *lost = scan(name, [&](Op op, std::string_view content) {
      if (op != Op::attachment) return;
      Attachment each = parse_attachment(content, name);
      if (each.name.compare(0, prefix.size(), prefix) == 0) found.push_back(std::move(each));
    });
    return found;
  }
  const std::string summary = file.summary();
  std::vector<Attachment> found;
  std::uint64_t end = 0;  // end of the attachment before: each is read once, so all fit into the file's size
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
