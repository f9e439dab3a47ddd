#pragma once

#include <zlib.h>

#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

/// Writes an MCAP file: messages in chunks compressed with zstd, indexes of messages and chunks, statistics,
/// and checksums of everything. Equal input gives equal bytes.
///
///     Writer writer(stream, "slalom 1.0");
///     const auto schema = writer.add_schema("foxglove.LaserScan", "jsonschema", text);
///     const auto channel = writer.add_channel("/scan", "json", schema);
///     writer.add_message(channel, nanoseconds, json);
///     writer.finish();
class Writer {
 public:
  /// `chunk_size`: bytes of messages before compression after which a chunk is closed.
  Writer(std::ostream& stream, const std::string& library, std::size_t chunk_size = 1u << 20);

  std::uint16_t add_schema(const std::string& name, const std::string& encoding, std::string_view data);
  std::uint16_t add_channel(const std::string& topic, const std::string& message_encoding,
                            std::uint16_t schema);
  /// `time`: ns; not before that of an earlier message.
  void add_message(std::uint16_t channel, std::uint64_t time, std::string_view data);
  void add_attachment(const std::string& name, const std::string& media_type, std::uint64_t time,
                      std::string_view data);
  void add_metadata(const std::string& name, const std::map<std::string, std::string>& values);

  /// Writes the indexes and the end of the file. The state of the stream tells whether all was written.
  void finish();

 private:
  using Times = std::vector<std::pair<std::uint64_t, std::uint64_t>>;  ///< ns, offset in the chunk

  void write(std::string_view bytes);
  void write_record(Op op, const Bytes& content);
  void close_chunk();

  std::ostream& stream_;
  std::size_t chunk_size_;
  std::uint64_t offset_ = 0;
  std::uint32_t crc_ = 0;  ///< checksum of all that was written
  Bytes chunk_;
  std::map<std::uint16_t, Times> chunk_times_;                  ///< times of each channel
  std::uint64_t chunk_first_ = 0, first_ = 0, last_ = 0;        ///< ns
  Bytes schemas_, channels_, chunks_, attachments_, metadata_;  ///< records of the summary
  std::uint16_t schema_count_ = 0;
  std::uint32_t chunk_count_ = 0, attachment_count_ = 0, metadata_count_ = 0;
  std::map<std::uint16_t, std::uint64_t> counts_;  ///< messages of each channel
  std::uint64_t messages_ = 0;
};

}  // namespace slalom::view::mcap
