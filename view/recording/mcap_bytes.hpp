#pragma once

#include <zlib.h>

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

/// MCAP files (https://mcap.dev/spec) consist of records: an opcode, a length and a content. Numbers are
/// little-endian; texts and lists follow their length in bytes.
namespace slalom::view::mcap {

inline constexpr std::string_view magic{"\x89MCAP0\r\n", 8};

enum class Op : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0a,
  statistics = 0x0b,
  metadata = 0x0c,
  metadata_index = 0x0d,
  data_end = 0x0f,
};

/// Returns the CRC-32 of bytes that follow others, whose CRC-32 is `before`.
inline std::uint32_t crc(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

/// The content of records, built by appending.
class Bytes {
 public:
  template <class T>
  Bytes& put(T value) {
    static_assert(std::is_integral_v<T> || std::is_enum_v<T>);
    out_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Bytes& raw(std::string_view bytes) {
    out_ += bytes;
    return *this;
  }
  Bytes& text(std::string_view value) { return put(static_cast<std::uint32_t>(value.size())).raw(value); }
  Bytes& block(std::string_view value) { return put(static_cast<std::uint64_t>(value.size())).raw(value); }
  Bytes& texts(const std::map<std::string, std::string>& values) {
    Bytes inner;
    for (const auto& [key, value] : values) inner.text(key).text(value);
    return text(inner.view());
  }
  /// Appends a list of pairs of numbers.
  template <class Pairs>
  Bytes& pairs(const Pairs& values) {
    Bytes inner;
    for (const auto& [key, value] : values) inner.put(key).put(value);
    return text(inner.view());
  }
  /// Appends a whole record.
  Bytes& record(Op op, const Bytes& content) { return put(op).block(content.view()); }

  std::string_view view() const noexcept { return out_; }
  std::uint64_t size() const noexcept { return out_.size(); }
  void clear() noexcept { out_.clear(); }

 private:
  std::string out_;
};

}  // namespace slalom::view::mcap
