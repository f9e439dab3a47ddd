#include "view/recording/mcap_repair.hpp"

#include <zstd.h>

#include <map>
#include <optional>

#include "slalom/core/error.hpp"
#include "view/recording/mcap_reader.hpp"
#include "view/recording/mcap_writer.hpp"

namespace slalom::view::mcap {
namespace {

constexpr std::uint64_t max_uncompressed = std::uint64_t{1} << 28;  // bytes of a chunk

/// The records of a chunk. Throws IoError if the chunk is damaged, or compressed in another way.
std::string unpack(std::string_view chunk, const std::string& file) {
  Reader reader(chunk, file);
  reader.take(16);  // its first and last time
  const auto size = reader.get<std::uint64_t>();
  const auto sum = reader.get<std::uint32_t>();
  const std::string compression = reader.text();
  const std::string_view packed = reader.take(reader.get<std::uint64_t>());
  if (compression != "zstd") throw IoError(file, 0, "has a chunk compressed with '" + compression + "'");
  if (size > max_uncompressed) throw IoError(file, 0, "is damaged: a chunk is too large");
  std::string records(size, '\0');
  const std::size_t got = ZSTD_decompress(records.data(), records.size(), packed.data(), packed.size());
  if (ZSTD_isError(got) || got != size || (sum != 0 && crc(records) != sum))
    throw IoError(file, 0, "is damaged: a chunk has a wrong checksum");
  return records;
}

/// Hands the records of a recording to a writer.
class Copier {
 public:
  Copier(const std::string& file, std::ostream& out) : file_(file), out_(out) {}

  void take(Op op, std::string_view content) {
    Reader reader(content, file_);
    if (op == Op::header && writer_) {
      throw IoError(file_, 0, "is damaged: it has a second header");
    } else if (op == Op::header) {
      reader.text();  // the profile
      writer_.emplace(out_, reader.text());
    } else if (!writer_) {
      throw IoError(file_, 0, "is damaged: it does not begin with a header");
    } else if (op == Op::metadata) {
      metadata(reader);
    } else if (op == Op::chunk) {
      chunk(unpack(content, file_));
    } else if (op == Op::attachment) {
      const Attachment whole = parse_attachment(content, file_);
      writer_->add_attachment(whole.name, whole.media_type, whole.time, whole.data);
      ++done_.attachments;
    }
  }
  Repaired finish(std::uint64_t lost) {
    if (!writer_) throw IoError(file_, 0, "has no whole record");
    writer_->finish();
    done_.lost = lost;
    return done_;
  }

 private:
  void metadata(Reader& reader) {
    const std::string name = reader.text(), pairs = reader.text();
    std::map<std::string, std::string> values;
    for (Reader rest(pairs, file_); !rest.done();) {
      const std::string key = rest.text();
      values[key] = rest.text();
    }
    writer_->add_metadata(name, values);
  }
  void chunk(const std::string& records) {
    for (Reader all(records, file_); !all.done();) {
      const auto op = static_cast<Op>(all.get<std::uint8_t>());
      Reader reader(all.take(all.get<std::uint64_t>()), file_);
      if (op == Op::schema) {
        const auto id = reader.get<std::uint16_t>();
        const std::string name = reader.text(), encoding = reader.text();
        schemas_[id] = writer_->add_schema(name, encoding, reader.text());
      } else if (op == Op::channel) {
        const auto id = reader.get<std::uint16_t>(), schema = reader.get<std::uint16_t>();
        const std::string topic = reader.text();
        channels_[id] = writer_->add_channel(topic, reader.text(), new_id(schemas_, schema));
      } else if (op == Op::message) {
        const auto channel = reader.get<std::uint16_t>();
        reader.get<std::uint32_t>();  // its number
        const auto time = reader.get<std::uint64_t>();
        reader.get<std::uint64_t>();  // when it was published
        writer_->add_message(new_id(channels_, channel), time, reader.rest());
        ++done_.messages;
      }
    }
  }
  std::uint16_t new_id(const std::map<std::uint16_t, std::uint16_t>& ids, std::uint16_t id) const {
    const auto found = ids.find(id);
    if (found == ids.end()) throw IoError(file_, 0, "is damaged: a record refers to one that is missing");
    return found->second;
  }

  const std::string& file_;
  std::ostream& out_;
  std::optional<Writer> writer_;
  std::map<std::uint16_t, std::uint16_t> schemas_, channels_;  ///< new ids by those of the file
  Repaired done_;
};

}  // namespace

Repaired repair(const std::string& file, std::ostream& out) {
  Copier copier(file, out);
  const std::uint64_t lost = scan(file, [&](Op op, std::string_view content) { copier.take(op, content); });
  return copier.finish(lost);
}

}  // namespace slalom::view::mcap
