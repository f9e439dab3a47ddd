#pragma once

#include <ostream>
#include <utility>
#include <vector>

#include "view/recording/mcap_bytes.hpp"

namespace slalom::view::mcap {

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
