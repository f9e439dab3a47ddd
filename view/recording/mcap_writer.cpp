#include "view/recording/mcap_writer.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <stdexcept>

namespace slalom::view::mcap {
namespace {

constexpr int compression_level = 3;

std::uint32_t crc(std::uint32_t before, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::string compress(std::string_view bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), compression_level);
  if (ZSTD_isError(size)) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
  out.resize(size);
  return out;
}

}  // namespace

Writer::Writer(std::ostream& stream, const std::string& library, std::size_t chunk_size)
    : stream_(stream), chunk_size_(chunk_size) {
  write(magic);
  write_record(Op::header, Bytes().text("").text(library).view());
}

void Writer::write(std::string_view bytes) {
  stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  crc_ = crc(crc_, bytes);
  offset_ += bytes.size();
}

void Writer::write_record(Op op, std::string_view content) {
  write(Bytes().put(static_cast<std::uint8_t>(op)).put(static_cast<std::uint64_t>(content.size())).view());
  write(content);
}

std::uint16_t Writer::add_schema(const std::string& name, const std::string& encoding,
                                 std::string_view data) {
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
  schemas_.emplace_back(Bytes().put(id).text(name).text(encoding).text(data).view());
  chunk_.record(Op::schema, schemas_.back());
  return id;
}

std::uint16_t Writer::add_channel(const std::string& topic, const std::string& message_encoding,
                                  std::uint16_t schema) {
  const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
  channels_.emplace_back(Bytes().put(id).put(schema).text(topic).text(message_encoding).texts({}).view());
  chunk_.record(Op::channel, channels_.back());
  counts_[id] = 0;
  return id;
}

void Writer::add_message(std::uint16_t channel, std::uint64_t time, std::string_view data) {
  auto& count = counts_.at(channel);
  chunk_times_[channel].emplace_back(time, chunk_.size());
  constexpr std::size_t head = 2 + 4 + 8 + 8;
  chunk_.put(static_cast<std::uint8_t>(Op::message)).put(static_cast<std::uint64_t>(head + data.size()));
  chunk_.put(channel).put(static_cast<std::uint32_t>(count)).put(time).put(time).raw(data);
  chunk_first_ = chunk_has_messages_ ? std::min(chunk_first_, time) : time;
  chunk_last_ = chunk_has_messages_ ? std::max(chunk_last_, time) : time;
  first_ = messages_ > 0 ? std::min(first_, time) : time;
  last_ = messages_ > 0 ? std::max(last_, time) : time;
  chunk_has_messages_ = true;
  ++count;
  ++messages_;
  if (chunk_.size() >= chunk_size_) close_chunk();
}

void Writer::close_chunk() {
  if (chunk_.size() == 0) return;
  const std::string packed = compress(chunk_.view());
  ChunkIndex index{chunk_first_, chunk_last_, offset_, 0, {}, 0, packed.size(), chunk_.size()};
  Bytes content;
  content.put(chunk_first_).put(chunk_last_).put(static_cast<std::uint64_t>(chunk_.size()));
  content.put(crc(0, chunk_.view())).text("zstd").block(packed);
  write_record(Op::chunk, content.view());
  index.length = offset_ - index.start;
  write_indexes(index);
  chunks_.push_back(std::move(index));
  chunk_.clear();
  chunk_first_ = chunk_last_ = 0;
  chunk_has_messages_ = false;
}

void Writer::write_indexes(ChunkIndex& index) {
  const std::uint64_t begin = offset_;
  for (auto& [channel, times] : chunk_times_) {
    if (times.empty()) continue;
    std::stable_sort(times.begin(), times.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    index.index_offsets[channel] = offset_;
    write_record(Op::message_index, Bytes().put(channel).pairs(times).view());
    times.clear();
  }
  index.index_length = offset_ - begin;
}

void Writer::add_attachment(const std::string& name, const std::string& media_type, std::uint64_t time,
                            std::string_view data) {
  close_chunk();
  const std::uint64_t begin = offset_;
  Bytes content;
  content.put(time).put(std::uint64_t{0}).text(name).text(media_type).block(data);
  content.put(crc(0, content.view()));
  write_record(Op::attachment, content.view());
  Bytes index;
  index.put(begin).put(offset_ - begin).put(time).put(std::uint64_t{0});
  index.put(static_cast<std::uint64_t>(data.size())).text(name).text(media_type);
  attachment_index_.record(Op::attachment_index, index.view());
  ++attachments_;
}

void Writer::add_metadata(const std::string& name, const std::map<std::string, std::string>& values) {
  close_chunk();
  const std::uint64_t begin = offset_;
  write_record(Op::metadata, Bytes().text(name).texts(values).view());
  metadata_index_.record(Op::metadata_index, Bytes().put(begin).put(offset_ - begin).text(name).view());
  ++metadata_;
}

std::string Writer::statistics() const {
  Bytes content;
  content.put(messages_).put(static_cast<std::uint16_t>(schemas_.size()));
  content.put(static_cast<std::uint32_t>(channels_.size())).put(attachments_).put(metadata_);
  content.put(static_cast<std::uint32_t>(chunks_.size())).put(first_).put(last_).pairs(counts_);
  return std::string(content.view());
}

/// The summary that begins at `start`, and the records that tell where its groups are.
std::string Writer::summary(std::uint64_t start, std::string& offsets) const {
  Bytes all, groups;
  const auto group = [&](Op op, std::string_view records) {
    if (records.empty()) return;
    Bytes content;
    content.put(static_cast<std::uint8_t>(op)).put(start + all.size());
    content.put(static_cast<std::uint64_t>(records.size()));
    groups.record(Op::summary_offset, content.view());
    all.raw(records);
  };
  Bytes schemas, channels, chunks, figures;
  for (const auto& each : schemas_) schemas.record(Op::schema, each);
  for (const auto& each : channels_) channels.record(Op::channel, each);
  for (const ChunkIndex& each : chunks_) {
    Bytes content;
    content.put(each.first_time).put(each.last_time).put(each.start).put(each.length);
    content.pairs(each.index_offsets).put(each.index_length).text("zstd");
    content.put(each.compressed).put(each.uncompressed);
    chunks.record(Op::chunk_index, content.view());
  }
  figures.record(Op::statistics, statistics());
  group(Op::schema, schemas.view());
  group(Op::channel, channels.view());
  group(Op::statistics, figures.view());
  group(Op::chunk_index, chunks.view());
  group(Op::attachment_index, attachment_index_.view());
  group(Op::metadata_index, metadata_index_.view());
  offsets = groups.view();
  return std::string(all.view());
}

void Writer::finish() {
  close_chunk();
  write_record(Op::data_end, Bytes().put(crc_).view());
  const std::uint64_t start = offset_;
  std::string offsets;
  const std::string records = summary(start, offsets);
  crc_ = 0;
  write(records);
  const std::uint64_t offsets_start = offset_;
  write(offsets);
  Bytes footer;
  constexpr std::uint64_t footer_length = 8 + 8 + 4;
  footer.put(static_cast<std::uint8_t>(Op::footer)).put(footer_length).put(start).put(offsets_start);
  write(footer.view());
  write(Bytes().put(crc_).view());
  write(magic);
}

}  // namespace slalom::view::mcap
