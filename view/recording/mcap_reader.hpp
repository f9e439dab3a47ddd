#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "slalom/core/error.hpp"
#include "view/recording/mcap_bytes.hpp"

namespace slalom::view::mcap {

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
  /// The rest that has not been read.
  std::string_view rest() const { return bytes_.substr(at_); }
  bool done() const { return at_ == bytes_.size(); }

 private:
  std::string_view bytes_;
  const std::string& file_;
  std::size_t at_ = 0;
};

/// The checksum of MCAP: CRC-32.
std::uint32_t crc(std::string_view bytes);

struct Attachment {
  std::string name, media_type, data;
  std::uint64_t time = 0;  ///< ns
};

/// An attachment from the content of its record. Throws IoError that names `file` if it is damaged.
Attachment parse_attachment(std::string_view content, const std::string& file);

/// Hands over the records of a file up to the end of its data or, if it was cut, to its last whole record;
/// also where `take` throws IoError, since it finds a record damaged. Returns the number of bytes behind
/// that; 0 for a recording that was finished. Throws IoError if the file is not MCAP or cannot be read.
std::uint64_t scan(const std::string& file, const std::function<void(Op, std::string_view)>& take);

/// The attachments of an MCAP file whose names begin with `prefix`, in the order of the file; found by the
/// index at its end, checksums checked. Of a file that was cut: those that are whole, and `lost` receives the
/// number of bytes that are not. Throws IoError if a file is not MCAP, damaged, or cut without `lost`.
std::vector<Attachment> read_attachments(const std::string& file, std::string_view prefix,
                                         std::uint64_t* lost = nullptr);

}  // namespace slalom::view::mcap
