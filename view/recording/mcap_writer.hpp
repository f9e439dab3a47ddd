#pragma once

#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <string_view>
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
  /// `time`: ns.
  void add_message(std::uint16_t channel, std::uint64_t time, std::string_view data);
  void add_attachment(const std::string& name, const std::string& media_type, std::uint64_t time,
                      std::string_view data);
  void add_metadata(const std::string& name, const std::map<std::string, std::string>& values);

  /// Writes the indexes and the end of the file. The state of the stream tells whether all was written.
  void finish();

 private:
  struct ChunkIndex {
    std::uint64_t first_time, last_time, start, length;
    std::map<std::uint16_t, std::uint64_t> index_offsets;
    std::uint64_t index_length, compressed, uncompressed;
  };
  using Times = std::vector<std::pair<std::uint64_t, std::uint64_t>>;  ///< ns, offset in the chunk

  void write(std::string_view bytes);
  void write_record(Op op, std::string_view content);
  void close_chunk();
  void write_indexes(ChunkIndex& index);
  std::string summary(std::uint64_t start, std::string& offsets) const;
  std::string statistics() const;

  std::ostream& stream_;
  std::size_t chunk_size_;
  std::uint64_t offset_ = 0;
  std::uint32_t crc_ = 0;  ///< checksum of all that was written
  Bytes chunk_;
  std::uint64_t chunk_first_ = 0, chunk_last_ = 0, first_ = 0, last_ = 0;
  bool chunk_has_messages_ = false;
  std::map<std::uint16_t, Times> chunk_times_;
  std::vector<std::string> schemas_, channels_;  ///< contents of their records
  std::map<std::uint16_t, std::uint64_t> counts_;
  std::vector<ChunkIndex> chunks_;
  Bytes attachment_index_, metadata_index_;
  std::uint32_t attachments_ = 0, metadata_ = 0;
  std::uint64_t messages_ = 0;
};

}  // namespace slalom::view::mcap
