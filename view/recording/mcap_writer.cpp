#include "view/recording/mcap_writer.hpp"

#include <zstd.h>

#include <stdexcept>

namespace slalom::view::mcap {
namespace {

constexpr int compression_level = 9;

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
  write_record(Op::header, Bytes().text("").text(library));
}

void Writer::write(std::string_view bytes) {
  stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  crc_ = crc(bytes, crc_);
  offset_ += bytes.size();
}

void Writer::write_record(Op op, const Bytes& content) {
  write(Bytes().put(op).put(content.size()).view());
  write(content.view());
}

std::uint16_t Writer::add_schema(const std::string& name, const std::string& encoding,
                                 std::string_view data) {
  const Bytes content = Bytes().put(++schema_count_).text(name).text(encoding).text(data);
  schemas_.record(Op::schema, content);
  chunk_.record(Op::schema, content);
  return schema_count_;
}

std::uint16_t Writer::add_channel(const std::string& topic, const std::string& message_encoding,
                                  std::uint16_t schema) {
  const auto id = static_cast<std::uint16_t>(counts_.size() + 1);
  const Bytes content = Bytes().put(id).put(schema).text(topic).text(message_encoding).texts({});
  channels_.record(Op::channel, content);
  chunk_.record(Op::channel, content);
  counts_[id] = 0;
  return id;
}

void Writer::add_message(std::uint16_t channel, std::uint64_t time, std::string_view data) {
  if (messages_ == 0) first_ = time;
  if (chunk_times_.empty()) chunk_first_ = time;
  last_ = time;
  auto& count = counts_.at(channel);
  chunk_times_[channel].emplace_back(time, chunk_.size());
  constexpr std::uint64_t head = 2 + 4 + 8 + 8;
  chunk_.put(Op::message).put(head + data.size());
  chunk_.put(channel).put(static_cast<std::uint32_t>(count)).put(time).put(time).raw(data);
  ++count;
  ++messages_;
  if (chunk_.size() >= chunk_size_) close_chunk();
}

/// Writes the chunk, and an index of its messages for each channel.
void Writer::close_chunk() {
  if (chunk_.size() == 0) return;
  const std::uint64_t begin = offset_, last = chunk_times_.empty() ? 0 : last_;
  const std::string packed = compress(chunk_.view());
  Bytes content;
  content.put(chunk_first_).put(last).put(chunk_.size()).put(crc(chunk_.view())).text("zstd").block(packed);
  write_record(Op::chunk, content);
  const std::uint64_t end = offset_;
  std::map<std::uint16_t, std::uint64_t> offsets;
  for (const auto& [channel, times] : chunk_times_) {
    offsets[channel] = offset_;
    write_record(Op::message_index, Bytes().put(channel).pairs(times));
  }
  Bytes index;
  index.put(chunk_first_).put(last).put(begin).put(end - begin).pairs(offsets).put(offset_ - end);
  index.text("zstd").put(std::uint64_t{packed.size()}).put(chunk_.size());
  chunks_.record(Op::chunk_index, index);
  ++chunk_count_;
  chunk_.clear();
  chunk_times_.clear();
  chunk_first_ = 0;
}

void Writer::add_attachment(const std::string& name, const std::string& media_type, std::uint64_t time,
                            std::string_view data) {
  close_chunk();
  const std::uint64_t begin = offset_;
  Bytes content;
  content.put(time).put(std::uint64_t{0}).text(name).text(media_type).block(data);
  content.put(crc(content.view()));
  write_record(Op::attachment, content);
  Bytes index;
  index.put(begin).put(offset_ - begin).put(time).put(std::uint64_t{0}).put(std::uint64_t{data.size()});
  attachments_.record(Op::attachment_index, index.text(name).text(media_type));
  ++attachment_count_;
}

void Writer::add_metadata(const std::string& name, const std::map<std::string, std::string>& values) {
  close_chunk();
  const std::uint64_t begin = offset_;
  write_record(Op::metadata, Bytes().text(name).texts(values));
  metadata_.record(Op::metadata_index, Bytes().put(begin).put(offset_ - begin).text(name));
  ++metadata_count_;
}

void Writer::finish() {
  close_chunk();
  write_record(Op::data_end, Bytes().put(crc_));
  const std::uint64_t summary = offset_;
  crc_ = 0;
  Bytes statistics;
  statistics.put(messages_).put(schema_count_).put(static_cast<std::uint32_t>(counts_.size()));
  statistics.put(attachment_count_).put(metadata_count_).put(chunk_count_);
  statistics.put(first_).put(last_).pairs(counts_);
  for (const Bytes& each :
       {schemas_, channels_, Bytes().record(Op::statistics, statistics), chunks_, attachments_, metadata_})
    write(each.view());
  constexpr std::uint64_t footer_length = 8 + 8 + 4, no_offsets = 0;
  write(Bytes().put(Op::footer).put(footer_length).put(summary).put(no_offsets).view());
  write(Bytes().put(crc_).view());
  write(magic);
}

}  // namespace slalom::view::mcap
