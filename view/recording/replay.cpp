#include "view/recording/replay.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "view/protocol/frame_reader.hpp"
#include "view/recording/encodings.hpp"
#include "view/recording/mcap_bytes.hpp"

namespace slalom::view {
namespace {

constexpr int frames_per_segment = 400;

/// Reads the content of an attachment's record: adds it to the segments if it is one.
void add_segment(std::vector<std::string>& segments, std::string_view content, const std::string& file) {
  PayloadReader reader(content);
  const auto text = [&] { return reader.take(reader.get<std::uint32_t>()); };
  reader.take(16);  // the times to which it belongs and at which it was made
  const std::string_view name = text();
  text();  // its media type
  const std::string_view data = reader.take(reader.get<std::uint64_t>());
  const auto sum = reader.get<std::uint32_t>();
  if (sum != 0 && mcap::crc(content.substr(0, content.size() - 4)) != sum)
    throw IoError(file, 0, "is damaged: " + std::string(name) + " has a wrong checksum");
  if (name.starts_with("replay/")) segments.emplace_back(data);
}

}  // namespace

void ReplaySegments::add(char kind, std::string_view message) {
  const auto length = static_cast<std::uint32_t>(message.size());
  segment_ += kind;
  segment_.append(reinterpret_cast<const char*>(&length), sizeof length);
  segment_ += message;
}

void ReplaySegments::add_frame(std::string_view message) {
  add(1, message);
  if (++frames_ >= frames_per_segment) finish();
}

void ReplaySegments::finish() {
  if (segment_.empty()) return;
  take_(gzip(segment_));
  segment_.clear();
  frames_ = 0;
}

std::string replay_page(std::string page, const std::vector<std::string>& segments) {
  std::string data;
  for (const std::string& segment : segments)
    data += "<script type=\"application/x-slalom-replay\">" + base64(segment) + "</script>\n";
  const std::size_t end = page.rfind("</body>");
  return page.insert(end == std::string::npos ? page.size() : end, data);
}

std::vector<std::string> load_replay(const std::string& file, std::uint64_t* lost) {
  constexpr std::size_t head = 1 + 8;  // bytes before the content of a record
  const std::string read = read_file(file, std::numeric_limits<std::uint64_t>::max());
  const std::string_view bytes = read;
  if (!bytes.starts_with(mcap::magic)) throw IoError(file, 0, "is not an MCAP recording");
  const bool is_cut = !bytes.ends_with(mcap::magic);
  if (is_cut && !lost) throw IoError(file, 0, "is incomplete: the recording was not finished");
  const auto ends_too_soon = [&] { return IoError(file, 0, "is damaged: a record ends too soon"); };
  std::vector<std::string> segments;
  std::size_t at = mcap::magic.size();
  while (bytes.size() - at >= head) {
    PayloadReader record(bytes.substr(at));
    const auto op = record.get<mcap::Op>();
    const auto length = record.get<std::uint64_t>();
    if (op == mcap::Op::data_end) at = bytes.size();
    if (at == bytes.size() || length > bytes.size() - at - head) break;
    try {
      if (op == mcap::Op::attachment) add_segment(segments, record.take(length), file);
    } catch (const std::invalid_argument&) {
      if (is_cut) break;
      throw ends_too_soon();
    } catch (const IoError&) {
      if (is_cut) break;
      throw;
    }
    at += head + length;
  }
  if (!is_cut && at < bytes.size()) throw ends_too_soon();
  if (lost) *lost = is_cut ? bytes.size() - at : 0;
  if (segments.empty())
    throw IoError(file, 0, "contains nothing to replay; recordings of slalom drive and slalom view do");
  return segments;
}

}  // namespace slalom::view
