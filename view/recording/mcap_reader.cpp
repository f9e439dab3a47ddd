#include "view/recording/mcap_reader.hpp"

#include <zstd.h>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "view/protocol/frame_reader.hpp"
#include "view/recording/mcap_writer.hpp"

namespace slalom::view::mcap {
namespace {

constexpr std::uint64_t most_bytes = std::uint64_t{1} << 32;  // size of a file
constexpr std::uint64_t most_chunk = std::uint64_t{1} << 30;  // bytes, decompressed
/// Bytes of a chunk that may be of any ratio, and the largest ratio of others to their compressed size.
constexpr std::uint64_t most_small_chunk = std::uint64_t{1} << 26, most_ratio = 1000;
constexpr std::size_t record_head = 1 + 8;  // bytes before the content of a record

std::string_view text(PayloadReader& from) {
  return from.take(from.get<std::uint32_t>());
}

/// Reads records and passes on what they contain.
class RecordReader {
 public:
  RecordReader(const std::string& file, const Receivers& receivers) : file_(file), receivers_(receivers) {}

  /// Reads records up to the end of the data. Returns the bytes that were read: fewer than there are if a
  /// record ends too soon, or, with `may_be_cut`, is damaged.
  std::size_t read(std::string_view bytes, bool may_be_cut) {
    std::size_t at = 0;
    while (bytes.size() - at >= record_head) {
      PayloadReader record(bytes.substr(at));
      const auto op = record.get<Op>();
      const auto length = record.get<std::uint64_t>();
      if (op == Op::data_end) return bytes.size();
      if (length > bytes.size() - at - record_head) break;
      try {
        read_record(op, record.take(length));
      } catch (const std::invalid_argument&) {
        if (may_be_cut) break;
        throw IoError(file_, 0, "is damaged: a record ends too soon");
      } catch (const IoError&) {
        if (may_be_cut) break;
        throw;
      }
      at += record_head + length;
    }
    return at;
  }

 private:
  struct Channel {
    std::string topic, schema, encoding;
  };

  void read_record(Op op, std::string_view content) {
    PayloadReader reader(content);
    if (op == Op::attachment && receivers_.attachment) read_attachment(content);
    if (!receivers_.message) return;
    if (op == Op::schema) {
      const auto id = reader.get<std::uint16_t>();
      schemas_[id] = text(reader);
    } else if (op == Op::channel) {
      const auto id = reader.get<std::uint16_t>(), schema = reader.get<std::uint16_t>();
      Channel& channel = channels_[id];
      channel.topic = text(reader);
      channel.encoding = text(reader);
      channel.schema = schemas_[schema];
    } else if (op == Op::message) {
      const Channel& channel = channels_[reader.get<std::uint16_t>()];
      reader.get<std::uint32_t>();  // its number in the channel
      const auto time = reader.get<std::uint64_t>();
      reader.get<std::uint64_t>();  // when it was published
      constexpr std::size_t head = 2 + 4 + 8 + 8;
      receivers_.message({channel.topic, channel.schema, channel.encoding, time, content.substr(head)});
    } else if (op == Op::chunk) {
      read_chunk(reader);
    }
  }

  void read_attachment(std::string_view content) const {
    PayloadReader reader(content);
    reader.take(16);  // the times to which it belongs and at which it was made
    const std::string_view name = text(reader);
    text(reader);  // its media type
    const std::string_view data = reader.take(reader.get<std::uint64_t>());
    const auto sum = reader.get<std::uint32_t>();
    if (sum != 0 && crc(content.substr(0, content.size() - 4)) != sum)
      throw IoError(file_, 0, "is damaged: " + std::string(name) + " has a wrong checksum");
    receivers_.attachment(name, data);
  }

  void read_chunk(PayloadReader& reader) {
    reader.take(16);  // the times of its first and last message
    const auto size = reader.get<std::uint64_t>();
    const auto sum = reader.get<std::uint32_t>();
    const std::string_view compression = text(reader);
    std::string_view records = reader.take(reader.get<std::uint64_t>());
    std::string unpacked;
    if (compression == "zstd") {
      if (size > most_chunk) throw IoError(file_, 0, "has a chunk of more than 1 GiB");
      if (size > most_small_chunk && size / most_ratio > records.size())
        throw IoError(file_, 0, "has a chunk of more than 64 MiB and 1000 times its compressed size");
      unpacked.resize(size);
      if (ZSTD_decompress(unpacked.data(), size, records.data(), records.size()) != size)
        throw IoError(file_, 0, "is damaged: a chunk cannot be decompressed");
      records = unpacked;
    } else if (!compression.empty()) {
      throw IoError(file_, 0,
                    "has chunks compressed with " + std::string(compression) +
                        "; must be zstd or none, which `mcap compress --compression zstd` writes");
    }
    if (sum != 0 && crc(records) != sum) throw IoError(file_, 0, "is damaged: a chunk has a wrong checksum");
    if (read(records, false) != records.size()) throw std::invalid_argument("a chunk ends too soon");
  }

  const std::string& file_;
  const Receivers& receivers_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
};

}  // namespace

std::uint64_t read_records(const std::string& file, bool may_be_cut, const Receivers& receivers) {
  const std::string read = read_file(file, most_bytes);
  std::string_view bytes = read;
  if (!bytes.starts_with(magic)) throw IoError(file, 0, "is not an MCAP recording");
  const bool is_cut = !bytes.ends_with(magic);
  if (is_cut && !may_be_cut) throw IoError(file, 0, "is incomplete: the recording was not finished");
  bytes.remove_prefix(magic.size());
  const std::uint64_t lost = bytes.size() - RecordReader(file, receivers).read(bytes, is_cut);
  if (!is_cut && lost > 0) throw IoError(file, 0, "is damaged: a record ends too soon");
  return lost;
}

}  // namespace slalom::view::mcap
