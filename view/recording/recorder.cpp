#include "view/recording/recorder.hpp"

#include <charconv>
#include <cstdio>

#include "json/json.hpp"
#include "view/car/car_subject.hpp"
#include "view/embedded.hpp"
#include "view/recording/replay.hpp"

namespace slalom::view {
namespace {

constexpr std::uint64_t gap_between_drives = 1'000'000'000;  // ns

/// Whether a scalar of a frame is a wall-clock time.
bool is_wall_clock(std::string_view name) {
  return name.size() > 3 && name.substr(name.size() - 3) == "_ms" && name != "deadline_ms";
}

/// Whether the figure is an input or output of the planner, from which a car is identified.
bool is_exact(std::string_view name) {
  return name == "time" || name.starts_with("odometry_") || name.starts_with("command_");
}

/// The number with the digits of a float, whose text is half as long.
double short_value(double value) {
  if (!std::isfinite(value)) return value;
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, static_cast<float>(value)).ptr;
  double read = 0;
  std::from_chars(text, end, read);
  return read;
}

/// The number to 0.1 mm, 0.1 mm/s or 1e-4 rad.
double rounded(double value) {
  return std::round(1e4 * value) / 1e4;
}

/// The schema of an object whose fields are scalars of a frame, or null where there is no value.
Json figures_schema(bool wall_clock) {
  Json properties = {{"timestamp",
                      {{"type", "object"},
                       {"properties", {{"sec", {{"type", "integer"}}}, {"nsec", {{"type", "integer"}}}}}}}};
  for (const std::string& name : car_scalars())
    if (is_wall_clock(name) == wall_clock) properties[name] = {{"type", {"number", "null"}}};
  if (!wall_clock) {
    properties["covariance"] = {{"type", "array"}, {"items", {{"type", "number"}}}};
    properties["plan"] = {{"type", "array"}, {"items", {{"type", "array"}, {"items", {{"type", "number"}}}}}};
  }
  return {{"type", "object"}, {"properties", properties}};
}

}  // namespace

Recorder::Recorder(std::ostream& stream, RecorderOptions options)
    : options_(std::move(options)),
      writer_(stream, options_.program),
      replay_([this](const std::string& segment) { attach(segment); }, options_.everything) {
  writer_.add_metadata("slalom", options_.settings);
  const Json schemas = Json::parse(foxglove_schemas());
  std::map<std::string, std::uint16_t> ids;  // schemas that are in the file
  const auto add_channel = [&](const char* topic, const std::string& schema, const Json& content) {
    auto& id = ids[schema];
    if (id == 0) id = writer_.add_schema(schema, "jsonschema", content.dump());
    channels_.push_back(writer_.add_channel(topic, "json", id));
  };
  const std::pair<const char*, const char*> topics[] = {
      {"/tf", "foxglove.FrameTransform"},  {"/map", "foxglove.Grid"},
      {"/course", "foxglove.SceneUpdate"}, {"/scan", "foxglove.LaserScan"},
      {"/cars", "foxglove.SceneUpdate"},   {"/plan", "foxglove.SceneUpdate"}};
  for (const auto& [topic, schema] : topics) add_channel(topic, schema, schemas.at(schema));
  add_channel("/tick", "slalom.Tick", figures_schema(false));
  if (options_.wall_clock) add_channel("/wall_clock", "slalom.WallClock", figures_schema(true));
}

void Recorder::begin_drive() {
  offset_ = time_ > 0 ? time_ + gap_between_drives : 0;
  time_ = offset_;
}

void Recorder::add(Topic topic, const Json& message) {
  writer_.add_message(channels_[static_cast<std::size_t>(topic)], time_, json_text(message));
}

void Recorder::attach(const std::string& segment) {
  char name[32];
  std::snprintf(name, sizeof name, "replay/%05d.gz", segments_++);
  writer_.add_attachment(name, "application/gzip", time_, segment);
}

/// The states of the plan: x, y, yaw, speed, steering, lateral standard deviation.
std::vector<std::array<double, 6>> Recorder::plan_of(const FrameReader& reader) {
  const auto block = reader.block(Block::plan);
  if (block.empty()) return {};
  PayloadReader payload(block);
  std::vector<std::array<double, 6>> states(payload.get<std::uint32_t>());
  const double x = payload.get<double>(), y = payload.get<double>();
  for (auto& state : states) {
    for (double& each : state) each = payload.f32();
    state[0] += x;
    state[1] += y;
  }
  return states;
}

void Recorder::add_text(std::string_view json) {
  replay_.add_text(json);
}

void Recorder::add_course(std::string_view message) {
  replay_.add_course(message);
  const FrameReader reader(message);
  PayloadReader grid(reader.block(Block::grid));
  const auto width = grid.get<std::uint32_t>(), height = grid.get<std::uint32_t>();
  const auto resolution = grid.get<double>();
  const maps::Pose corner = grid.pose();
  std::string cells;
  for (auto runs = grid.get<std::uint32_t>(); runs > 0; --runs) {
    const auto run = grid.get<std::uint32_t>();
    constexpr char shades[] = {0, 100, 50};  // free, occupied, unknown
    cells.append(run & 0xffffffu, shades[std::min(run >> 24, 2u)]);
  }
  cells.resize(std::size_t{width} * height);
  add(Topic::map, foxglove::grid(time_, corner, width, resolution, "occupied", cells));

  PayloadReader path(reader.block(Block::path));
  const auto count = path.get<std::uint32_t>();
  const bool closed = path.get<std::uint32_t>() != 0;
  std::vector<maps::Point> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = path.f32();
    points.push_back({x, path.f32()});
    path.f32();  // the speed
  }
  if (closed && !points.empty()) points.push_back(points.front());
  foxglove::Scene scene(time_);
  scene.begin("course");
  scene.line(points, {0.5, 0.56, 0.64, 0.7}, 1);
  add(Topic::course, scene.message());
}

std::string Recorder::without_wall_clock(std::string_view frame, const FrameReader& reader) const {
  std::string copy(frame);
  const double none = std::numeric_limits<double>::quiet_NaN();
  const auto& names = car_scalars();
  const auto erase = [&](std::size_t scalars) {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (is_wall_clock(names[i])) std::memcpy(copy.data() + scalars + 8 * i, &none, sizeof none);
  };
  erase(reader.offset(Block::scalars));
  if (const auto ghost = reader.block(Block::ghost_frame); !ghost.empty())
    erase(reader.offset(Block::ghost_frame) + FrameReader(ghost).offset(Block::scalars));
  return copy;
}

void Recorder::add_frame(std::string_view frame) {
  const FrameReader reader(frame);
  PayloadReader payload(reader.block(Block::scalars));
  std::vector<double> scalars(car_scalars().size());
  for (double& each : scalars) each = payload.get<double>();
  constexpr std::size_t time_index = 1;
  time_ = offset_ + static_cast<std::uint64_t>(std::llround(1e9 * scalars[time_index]));
  replay_.add_frame(options_.wall_clock ? std::string(frame) : without_wall_clock(frame, reader));

  add_tick(reader, scalars);
  if (options_.everything)
    add_scene(reader);
  else if (steps_++ % small_scene_stride == 0)
    add_scene(FrameReader(small_frame(frame)));
}

void Recorder::finish() {
  replay_.finish();
  writer_.finish();
}

void Recorder::add_tick(const FrameReader& reader, const std::vector<double>& scalars) {
  Json tick = {{"timestamp", foxglove::timestamp(time_)}}, times = tick;
  const auto& names = car_scalars();
  for (std::size_t i = 0; i < names.size(); ++i)
    (is_wall_clock(names[i]) ? times : tick)[names[i]] =
        is_exact(names[i]) ? scalars[i] : short_value(scalars[i]);
  Json covariance = Json::array(), plan = Json::array();
  const std::string_view variances = reader.block(Block::covariance);
  PayloadReader variance(variances);
  for (std::size_t i = 0; i < variances.size() / 4; ++i) covariance.push_back(short_value(variance.f32()));
  for (const auto& [x, y, yaw, speed, steer, spread] : plan_of(reader))
    plan.push_back({rounded(x), rounded(y), rounded(yaw), rounded(speed), rounded(steer)});
  tick["covariance"] = covariance;
  tick["plan"] = plan;
  add(Topic::tick, tick);
  if (options_.wall_clock) add(Topic::times, times);
}

}  // namespace slalom::view
