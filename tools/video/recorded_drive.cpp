#include "tools/video/recorded_drive.hpp"

#include <algorithm>

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "view/protocol/frame_reader.hpp"
#include "view/recording/encodings.hpp"
#include "view/recording/replay.hpp"

namespace slalom::tools {
namespace {

using view::Block;
using view::PayloadReader;

constexpr std::uint64_t most_cells = 1u << 28;

maps::OccupancyGrid read_grid(PayloadReader from) {
  maps::OccupancyGrid grid;
  grid.width = static_cast<int>(from.get<std::uint32_t>());
  grid.height = static_cast<int>(from.get<std::uint32_t>());
  grid.resolution = from.get<double>();
  grid.origin = from.pose();
  const std::uint64_t cells = static_cast<std::uint64_t>(std::max(grid.width, 0)) *
                              static_cast<std::uint64_t>(std::max(grid.height, 0));
  if (cells > most_cells) throw std::invalid_argument("the map has too many cells");
  for (auto runs = from.get<std::uint32_t>(); runs > 0; --runs) {
    const auto run = from.get<std::uint32_t>();
    const std::size_t length = run & 0xffffffu;
    if (length > cells - grid.cells.size()) throw std::invalid_argument("the map has too many cells");
    grid.cells.insert(grid.cells.end(), length, static_cast<maps::Occupancy>(run >> 24));
  }
  maps::check_grid(grid);
  return grid;
}

std::vector<RecordedCandidate> read_candidates(PayloadReader from) {
  const std::size_t count = from.get<std::uint16_t>(), length = from.get<std::uint16_t>();
  std::vector<RecordedCandidate> all(count);
  for (auto& each : all) {
    from.take(3 * sizeof(float));  // costs by term
    each.cost = from.get<float>();
    each.weight = from.get<float>();
  }
  for (auto& each : all) each.collided = from.get<std::uint8_t>() != 0;
  from.align();
  const auto points = from.points(count * length);
  for (std::size_t i = 0; i < count; ++i)
    all[i].points.assign(points.begin() + static_cast<std::ptrdiff_t>(i * length),
                         points.begin() + static_cast<std::ptrdiff_t>((i + 1) * length));
  return all;
}

std::vector<std::vector<maps::Point>> read_guides(PayloadReader from) {
  const std::size_t guides = from.get<std::uint16_t>(), iterations = from.get<std::uint16_t>();
  const std::size_t length = from.get<std::uint16_t>();
  from.get<std::uint16_t>();
  const auto points = from.points(guides * iterations * length);
  std::vector<std::vector<maps::Point>> ends;
  for (auto at = points.end() - static_cast<std::ptrdiff_t>(iterations > 0 ? guides * length : 0);
       at != points.end(); at += static_cast<std::ptrdiff_t>(length))
    ends.emplace_back(at, at + static_cast<std::ptrdiff_t>(length));
  return ends;
}

std::vector<maps::Point> read_plan(PayloadReader from) {
  const auto count = from.get<std::uint32_t>();
  const double x = from.get<double>(), y = from.get<double>();
  std::vector<maps::Point> plan;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double dx = from.f32(), dy = from.f32();
    plan.push_back({x + dx, y + dy});
    from.take(4 * sizeof(float));  // yaw, speed, steering, spread
  }
  return plan;
}

std::vector<RecordedBody> read_bodies(PayloadReader from) {
  std::vector<RecordedBody> bodies;
  for (auto count = from.get<std::uint32_t>(); count > 0; --count) {
    from.get<std::uint16_t>();
    RecordedBody body{.kind = from.get<std::uint8_t>(), .collided = from.get<std::uint8_t>() != 0};
    const double x = from.f32(), y = from.f32(), yaw = from.f32(), length = from.f32();
    body.box = {{x, y, yaw}, length, from.f32()};
    bodies.push_back(body);
  }
  return bodies;
}

}  // namespace

RecordedDrive::RecordedDrive(const std::string& file) : file_(file) {
  std::uint64_t lost = 0;
  try {
    for (const std::string& segment : view::load_replay(file, &lost)) {
      const std::string messages = view::gunzip(segment);
      for (PayloadReader from(messages); !from.empty();) {
        const auto kind = from.get<char>();
        const std::string_view message = from.take(from.get<std::uint32_t>());
        if (kind == 0)
          take_text(message);
        else if (!view::FrameReader(message).block(Block::grid).empty())
          take_course(message);
        else
          frames_.emplace_back(message);
      }
    }
    if (frames_.empty() || map.cells.empty() || !(period > 0))
      throw std::invalid_argument("contains no drive of a car");
  } catch (const std::invalid_argument& error) {
    throw IoError(file, 0, error.what());
  }
}

void RecordedDrive::take_text(std::string_view text) {
  const Json message = parse_json(text);
  const auto type = member<std::string>(message, "type");
  if (type == "hello") {
    scalars_ = member(message, "scalars").get<std::vector<std::string>>();
    methods_ = member(message, "methods").get<std::vector<std::string>>();
  } else if (type == "state") {
    title = member<std::string>(message, "course") + ", seed " + member<std::string>(message, "seed");
    period = member<double>(message, "control_period");
  }
}

void RecordedDrive::take_course(std::string_view message) {
  const view::FrameReader reader(message);
  map = read_grid(PayloadReader(reader.block(Block::grid)));
  PayloadReader from(reader.block(Block::path));
  const auto count = from.get<std::uint32_t>();
  closed = from.get<std::uint32_t>() != 0;
  path.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = from.f32(), y = from.f32();
    path.push_back({x, y});
    from.f32();  // speed
  }
}

RecordedStep RecordedDrive::step(std::string_view message) const {
  const view::FrameReader reader(message);
  const auto scalar = [&](const char* name) {
    const auto at = std::find(scalars_.begin(), scalars_.end(), name) - scalars_.begin();
    PayloadReader from(reader.block(Block::scalars));
    from.take(sizeof(double) * static_cast<std::size_t>(at));
    return from.get<double>();
  };
  const auto read = [&](Block block, auto function) {
    const std::string_view payload = reader.block(block);
    return payload.empty() ? decltype(function(PayloadReader(payload))){} : function(PayloadReader(payload));
  };
  const auto read_line = [](PayloadReader from) { return from.points(from.get<std::uint32_t>()); };
  const double method = scalar("method"), collisions = scalar("contacts");
  RecordedStep step{.method = {},
                    .car = {scalar("x"), scalar("y"), scalar("yaw")},
                    .collisions = collisions > 0 && collisions < 1e6 ? static_cast<int>(collisions) : 0,
                    .candidates = read(Block::candidates, read_candidates),
                    .guides = read(Block::guides, read_guides),
                    .nominal = read(Block::nominal, read_line),
                    .plan = read(Block::plan, read_plan),
                    .bodies = read(Block::bodies, read_bodies)};
  if (method >= 0 && method < static_cast<double>(methods_.size()))
    step.method = methods_[static_cast<std::size_t>(method)];
  return step;
}

std::vector<RecordedStep> RecordedDrive::at(std::size_t frame) const {
  try {
    const std::string_view message = frames_.at(frame);
    std::vector<RecordedStep> steps = {step(message)};
    const std::string_view ghost = view::FrameReader(message).block(Block::ghost_frame);
    if (!ghost.empty()) steps.push_back(step(ghost));
    return steps;
  } catch (const std::invalid_argument& error) {
    throw IoError(file_, 0, error.what());
  }
}

}  // namespace slalom::tools
