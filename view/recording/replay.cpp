#include "view/recording/replay.hpp"

#include <algorithm>
#include <cstdint>

#include "slalom/core/error.hpp"
#include "view/recording/encodings.hpp"
#include "view/recording/mcap_reader.hpp"

namespace slalom::view {
namespace {

constexpr int frames_per_segment = 400;

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
  std::vector<std::string> segments;
  for (mcap::Attachment& each : mcap::read_attachments(file, "replay/", lost))
    segments.push_back(std::move(each.data));
  if (segments.empty())
    throw IoError(file, 0, "contains nothing to replay; recordings of slalom drive and slalom view do");
  return segments;
}

}  // namespace slalom::view
