#pragma once

#include <cstdint>
#include <cstring>
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
  summary_offset = 0x0e,
  data_end = 0x0f,
};

/// The content of records, built by appending.
class Bytes {
 public:
  template <class T>
  Bytes& put(T value) {
    static_assert(std::is_integral_v<T>);
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
  Bytes& record(Op op, std::string_view content) { return put(static_cast<std::uint8_t>(op)).block(content); }

  std::string_view view() const noexcept { return out_; }
  std::size_t size() const noexcept { return out_.size(); }
  void clear() noexcept { out_.clear(); }

 private:
  std::string out_;
};

}  // namespace slalom::view::mcap
