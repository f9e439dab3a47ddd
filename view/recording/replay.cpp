#include "view/recording/replay.hpp"

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "view/recording/encodings.hpp"
#include "view/recording/mcap_reader.hpp"
#include "view/recording/small_frame.hpp"

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

void ReplaySegments::add_text(std::string_view message) {
  Json json = everything_ ? Json() : parse_json_or_null(message);
  if (!json.is_object() || !json.contains("control_period")) return add(0, message);
  json["control_period"] = small_stride * json["control_period"].get<double>();  // from frame to frame
  add(0, json_text(json));
}

void ReplaySegments::add_frame(std::string_view message) {
  if (!everything_ && steps_++ % small_stride != 0) return;
  add(1, everything_ ? message : small_frame(message));
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
  const auto keep = [&](std::string_view name, std::string_view data) {
    if (name.starts_with("replay/")) segments.emplace_back(data);
  };
  const std::uint64_t unread = mcap::read_records(file, lost != nullptr, {.message = {}, .attachment = keep});
  if (lost) *lost = unread;
  if (segments.empty())
    throw IoError(
        file, 0, "contains nothing to replay; recordings of slalom drive and slalom view do, a bag does not");
  return segments;
}

}  // namespace slalom::view
