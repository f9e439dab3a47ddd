#include "view/recording/replay.hpp"

#include <algorithm>
#include <numeric>

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "view/protocol/frame_reader.hpp"
#include "view/recording/encodings.hpp"
#include "view/recording/mcap_reader.hpp"

namespace slalom::view {
namespace {

constexpr int frames_per_segment = 400;

constexpr std::uint16_t no_return = 65535;  // mm, beyond the range of every scanner

/// Puts figures whose last bits are zero, which compresses better.
void put_scalars(FrameWriter& to, std::string_view block) {
  PayloadReader scalars(block);
  for (std::size_t i = 0; i < block.size() / sizeof(double); ++i)
    to.put(static_cast<double>(static_cast<float>(scalars.get<double>())));
}

void put_scan(FrameWriter& to, PayloadReader scan) {
  to.put_pose(scan.pose());
  const auto beams = scan.get<std::uint32_t>();
  to.put(beams);
  for (std::uint32_t i = 0; i < beams; ++i) {
    const auto range = scan.get<std::uint16_t>();
    to.put(i % small_beams == 0 ? range : no_return);
  }
}

/// Half of the candidates that are kept are the heaviest, and the others lie evenly among the rest.
std::vector<std::size_t> kept_candidates(const std::vector<float>& weights) {
  std::vector<std::size_t> order(weights.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return weights[a] > weights[b]; });
  constexpr std::size_t heaviest = small_candidates / 2, others = small_candidates - heaviest;
  if (order.size() > small_candidates) {
    const std::size_t rest = order.size() - heaviest;
    for (std::size_t i = 0; i < others; ++i) order[heaviest + i] = order[heaviest + i * rest / others];
    order.resize(small_candidates);
  }
  std::sort(order.begin(), order.end());
  return order;
}

void put_candidates(FrameWriter& to, PayloadReader candidates) {
  constexpr std::size_t terms = 5;  // costs of each candidate; the last is its weight
  const std::size_t count = candidates.get<std::uint16_t>(), length = candidates.get<std::uint16_t>();
  std::vector<std::string_view> costs(count);
  std::vector<float> weights(count);
  for (std::size_t i = 0; i < count; ++i) {
    costs[i] = candidates.take(terms * sizeof(float));
    std::memcpy(&weights[i], costs[i].data() + (terms - 1) * sizeof(float), sizeof(float));
  }
  const std::string_view collided = candidates.take(count);
  candidates.align();
  PayloadReader head = candidates;  // origin of the points
  const double x = head.get<double>(), y = head.get<double>();
  const auto points = candidates.points(count * length);
  const auto kept = kept_candidates(weights);
  to.put(static_cast<std::uint16_t>(kept.size()));
  to.put(static_cast<std::uint16_t>(length));
  for (const std::size_t i : kept) to.append(costs[i]);
  for (const std::size_t i : kept) to.put(collided[i]);
  to.pad();
  to.begin_points({x, y});
  for (const std::size_t i : kept)
    for (std::size_t k = 0; k < length; ++k) to.put_point(points[i * length + k]);
}

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

std::string small_frame(std::string_view frame) {
  const FrameReader reader(frame);
  FrameWriter to;
  for (const Block kind : {Block::scalars, Block::scan, Block::candidates, Block::nominal, Block::plan,
                           Block::bodies, Block::covariance, Block::ghost_frame, Block::others}) {
    const std::string_view block = reader.block(kind);
    if (block.empty()) continue;
    to.begin(kind);
    if (kind == Block::scalars)
      put_scalars(to, block);
    else if (kind == Block::scan)
      put_scan(to, PayloadReader(block));
    else if (kind == Block::candidates)
      put_candidates(to, PayloadReader(block));
    else if (kind == Block::ghost_frame)
      to.append(small_frame(block));
    else
      to.append(block);
    to.end();
  }
  return to.take();
}

}  // namespace slalom::view
