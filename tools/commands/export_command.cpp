#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>

#include "slalom/core/files/write_file.hpp"
#include "tools/command_line/words.hpp"
#include "tools/commands/commands.hpp"
#include "tools/drawing/map_picture.hpp"
#include "tools/recording/replay_page.hpp"
#include "tools/video/recorded_drive.hpp"
#include "tools/video/video_file.hpp"

namespace slalom::tools {
namespace {

/// The part of a recording that a video shows, and how fast.
struct VideoSpan {
  double from = 0, to = 1e9;  ///< s from the beginning of the recording
  double speed = 1;           ///< ratio of recorded to shown time
};

constexpr int frame_rate = 25;                       // pictures a second
constexpr int width = 960, height = 540, band = 58;  // pixels; the band has names and key
constexpr int scene = height - band;                 // pixels
constexpr double closest = 150, following = 45;      // pixels for a metre: at most, and behind a car
constexpr double most_pixels = 2.4e7;                // image of the map

/// A world of a drive with its history.
struct Lane {
  std::vector<maps::Point> driven;
  std::vector<maps::Pose> hits;  ///< where the number of collisions rose
  int collisions = 0;

  void add(const RecordedStep& step) {
    driven.push_back({step.car.x, step.car.y});
    if (step.collisions > collisions) hits.push_back(step.car);
    collisions = step.collisions;
  }
};

/// Draws a control step through a view whose left edge is `left` pixels from that of the picture.
class LanePainter {
 public:
  LanePainter(Pen& pen, const MapView& view, double left) : pen_(pen), view_(view), left_(left) {}

  void draw(const RecordedDrive& drive, const RecordedStep& step, const Lane& lane) {
    line(drive.path, {.colour = path_colour, .width = 1.2, .dash = 8}, drive.closed);
    line(lane.driven, {.colour = driven_colour, .width = 2});
    draw_candidates(step.candidates);
    for (const auto& guide : step.guides) {
      line(guide, {.colour = guide_colour, .width = 2});
      if (!guide.empty()) dot(guide.back(), 3, guide_colour);
    }
    for (auto body = step.bodies.rbegin(); body != step.bodies.rend(); ++body) draw_body(*body);
    line(step.nominal, {.colour = nominal_colour, .width = 1.6, .dash = 5});
    line(step.plan, {.colour = plan_colour, .width = 3});
    for (const maps::Point& point : step.plan) dot(point, 2.6, plan_colour);
    for (const maps::Pose& at : lane.hits) draw_cross(at);
  }

 private:
  std::pair<double, double> pixel(const maps::Point& point) const {
    const maps::Point at = view_.pixel(point);
    return {left_ + at.x, at.y};
  }
  void line(const std::vector<maps::Point>& points, const Stroke& stroke, bool closed = false) {
    Pen::Points pixels;
    for (const maps::Point& point : points) pixels.push_back(pixel(point));
    if (pixels.size() > 1) pen_.stroke(pixels, stroke, closed);
  }
  void dot(const maps::Point& at, double radius, Colour colour) {
    const auto [x, y] = pixel(at);
    pen_.disc(x, y, radius, colour);
  }

  /// Draws the samples, those of least cost last: wide and opaque by their weight.
  void draw_candidates(std::vector<RecordedCandidate> all) {
    float low = INFINITY, high = -INFINITY, heaviest = 1e-12f;
    for (const auto& each : all) {
      heaviest = std::max(heaviest, each.weight);
      if (each.collided || !std::isfinite(each.cost)) continue;
      low = std::min(low, each.cost);
      high = std::max(high, each.cost);
    }
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
      return a.collided != b.collided ? a.collided : a.cost > b.cost;
    });
    for (const auto& each : all) {
      const double share = std::sqrt(std::max(0.0f, each.weight) / heaviest);
      const double cost = high > low ? std::clamp((each.cost - low) / (high - low), 0.0f, 1.0f) : 0;
      Colour colour = cost_colour(cost, 0.55 - 0.25 * cost + 0.45 * share);
      if (each.collided) (colour = hit_colour).opacity = 0.3 + 0.3 * share;
      line(each.points, {.colour = colour, .width = 1 + 2 * share});
    }
  }

  void draw_body(const RecordedBody& body) {
    const bool is_car = body.kind == 0 || body.kind == 4;
    const Colour fill = body.kind == 0   ? ink
                        : body.kind == 4 ? opponent_colour
                        : body.collided  ? hit_colour
                                         : obstacle_colour;
    const Colour rim = body.collided ? hit_colour : is_car ? white : obstacle_rim;
    const auto& [pose, length, wide] = body.box;
    if (body.kind == 3) {
      const auto [x, y] = pixel({pose.x, pose.y});
      return pen_.disc(x, y, 0.5 * length * view_.scale, fill, rim, 1.5);
    }
    const auto outline = [&](const sim::Box& box, Colour inside, Colour edge) {
      Pen::Points points;
      for (const maps::Point& corner : sim::corners(box)) points.push_back(pixel(corner));
      pen_.area(points, inside, edge, edge.opacity > 0 ? 1.5 : 0);
    };
    outline(body.box, fill, rim);
    // The window shows where the front is.
    const double ahead = 0.12 * length;
    const maps::Pose middle{pose.x + ahead * std::cos(pose.yaw), pose.y + ahead * std::sin(pose.yaw),
                            pose.yaw};
    if (is_car || body.kind == 1)
      outline({middle, 0.25 * length, 0.7 * wide}, is_car ? white : obstacle_rim, {0, 0, 0, 0});
  }

  void draw_cross(const maps::Pose& at) {
    const auto [x, y] = pixel({at.x, at.y});
    constexpr double arm = 10;
    for (const auto& [colour, wide] : {std::pair(white, 7.0), std::pair(hit_colour, 4.0)})
      for (const double side : {arm, -arm}) pen_.line(x - arm, y - side, x + arm, y + side, colour, wide);
  }

  Pen& pen_;
  const MapView& view_;
  double left_;
};

/// The pictures of a span.
class Film {
 public:
  Film(const RecordedDrive& drive, std::size_t first, std::size_t last)
      : drive_(drive), lanes_(drive.at(first).size()), lane_width_(width / static_cast<int>(lanes_.size())) {
    Bounds way;
    for (std::size_t i = first; i <= last; ++i)
      for (const RecordedStep& step : drive.at(i)) {
        way.include({step.car.x, step.car.y}, 1);
        if (!step.plan.empty()) way.include(step.plan.back(), 0.6);
      }
    const double fitting = std::min(lane_width_ / (way.right - way.left), scene / (way.top - way.low));
    double scale = std::min(fitting, closest);
    Bounds seen;
    if (fitting >= following) {
      middle_ = {0.5 * (way.left + way.right), 0.5 * (way.low + way.top)};
      seen.include(*middle_, 0.5 * lane_width_ / scale, 0.5 * scene / scale);
    } else {
      scale = following;
      for (const double x : {way.left, way.right})
        for (const double y : {way.low, way.top})
          seen.include({x, y}, 0.5 * lane_width_ / scale, 0.5 * scene / scale);
      scale = std::min(scale, std::sqrt(most_pixels / ((seen.right - seen.left) * (seen.top - seen.low))));
    }
    whole_ = {scale, seen.left, seen.top, static_cast<int>(std::ceil((seen.right - seen.left) * scale)) + 1,
              static_cast<int>(std::ceil((seen.top - seen.low) * scale)) + 1};
    ground_.emplace(whole_.width, whole_.height);
    ground_->pen().image(map_pixels(drive.map, whole_), whole_.width);
  }

  /// Adds a frame to the history.
  void pass(std::size_t frame) {
    steps_ = drive_.at(frame);
    for (std::size_t i = 0; i < steps_.size() && i < lanes_.size(); ++i) lanes_[i].add(steps_[i]);
  }

  /// The picture of the frame that was passed last.
  std::string pixels(const std::string& caption) {
    return to_pixels({width, height, [&](Pen& pen) {
                        for (std::size_t i = 0; i < steps_.size() && i < lanes_.size(); ++i)
                          draw_lane(pen, i);
                        draw_band(pen, caption);
                      }});
  }

 private:
  void draw_lane(Pen& pen, std::size_t index) {
    const RecordedStep& step = steps_[index];
    const double left = static_cast<double>(index) * lane_width_;
    const maps::Point middle = middle_.value_or(maps::Point{step.car.x, step.car.y});
    // Whole pixels of the ground, so that it does not shimmer.
    const double across = std::round((middle.x - whole_.left) * whole_.scale - 0.5 * lane_width_);
    const double down = std::round((whole_.top - middle.y) * whole_.scale - 0.5 * scene);
    const MapView view{whole_.scale, whole_.left + across / whole_.scale, whole_.top - down / whole_.scale,
                       lane_width_, scene};
    pen.clip(left, 0, lane_width_, scene);
    pen.shift(left - across, -down);
    ground_->drawing().draw(pen);
    pen.shift(across - left, down);
    LanePainter(pen, view, left).draw(drive_, step, lanes_[index]);
    const std::string title = formatted("%s: %d collision%s", step.method.c_str(), step.collisions,
                                        step.collisions == 1 ? "" : "s");
    pen.box(left + 10, 10, pen.text_width(title, 17, true) + 20, 30, white, rule, 1, 5);
    pen.text(left + 20, 31, 17, title, step.collisions > 0 ? hit_colour : ink, 0, true);
    pen.unclip();
    if (index > 0) pen.rectangle(left - 1, 0, 2, scene, ink);
  }

  void draw_band(Pen& pen, const std::string& caption) {
    pen.rectangle(0, scene, width, band, white);
    pen.rectangle(0, scene, width, 1, rule);
    pen.text(12, scene + 24, 16, caption, ink, 0, true);
    const double metres = whole_.scale > 80 ? 1 : 2, bar = metres * whole_.scale, right = width - 12;
    pen.path({{right - bar, scene + 14}, {right - bar, scene + 21}, {right, scene + 21}, {right, scene + 14}},
             ink, 2);
    pen.text(right - bar - 8, scene + 22, 14, formatted("%.0f m", metres), ink, 1);

    double at = 12;
    const double base = scene + 46;
    const auto name = [&](const std::string& words) {
      pen.text(at, base, 14, words, ink);
      at += pen.text_width(words, 14) + 22;
    };
    const auto entry = [&](const std::string& words, Colour colour) {
      pen.rectangle(at, base - 8, 18, 5, colour);
      at += 24;
      name(words);
    };
    entry("plan", plan_colour);
    for (int i = 0; i < 60; ++i) pen.rectangle(at + i, base - 9, 1.5, 7, cost_colour(i / 59.0, 1));
    at += 66;
    name("samples, low to high cost");
    const auto any = [&](auto has) { return std::any_of(steps_.begin(), steps_.end(), has); };
    const auto any_body = [&](auto is_one) {
      return any([&](const auto& step) { return std::ranges::any_of(step.bodies, is_one); });
    };
    entry("samples that collide", hit_colour);
    if (any([](const auto& step) { return !step.guides.empty(); })) entry("guides", guide_colour);
    entry("driven", driven_colour);
    if (any_body([](const auto& body) { return body.kind > 0 && body.kind < 4; }))
      entry("obstacle", obstacle_colour);
    if (any_body([](const auto& body) { return body.kind == 4; })) entry("opponent", opponent_colour);
  }

  const RecordedDrive& drive_;
  std::vector<Lane> lanes_;
  int lane_width_;
  std::optional<maps::Point> middle_;  ///< centre of the picture if it stands still
  MapView whole_;                      ///< all that any picture shows
  std::optional<Canvas> ground_;
  std::vector<RecordedStep> steps_;
};

/// Writes a video of a drive from above: samples, guides, plan, cars and obstacles; a second controller
/// stands beside the first. The picture stands still if it can show all of the way, otherwise it follows the
/// car. Returns the number of pictures. Throws IoError, and std::invalid_argument if the span is empty.
int write_video(const RecordedDrive& drive, const VideoSpan& span, const std::filesystem::path& file) {
  const double end = std::min(span.to, drive.duration());
  if (!(span.from < end))
    throw std::invalid_argument(formatted("--from: must be before the recording ends, at %.2f s", end));
  const auto frame_at = [&](double time) {
    return std::min(static_cast<std::size_t>(time / drive.period + 1e-6), drive.frames() - 1);
  };
  const std::size_t first = frame_at(span.from);
  Film film(drive, first, frame_at(end));
  VideoFile video(file, width, height, frame_rate);
  std::size_t next = first;
  int pictures = 0;
  for (; pictures == 0 || span.from + pictures * span.speed / frame_rate < end; ++pictures) {
    const double time = span.from + pictures * span.speed / frame_rate;
    for (; next <= frame_at(time); ++next) film.pass(next);
    video.add(
        film.pixels(formatted("%s \xC2\xB7 %.2f s%s", drive.title.c_str(), time,
                              span.speed == 1 ? "" : formatted(" \xC2\xB7 speed %g", span.speed).c_str())));
  }
  video.finish();
  return pictures;
}

struct ExportArguments {
  std::string recording, file;
  VideoSpan span;
};

int export_recording(const ExportArguments& arguments, bool has_span) {
  const std::filesystem::path file = arguments.file;
  if (file.extension() == ".html") {
    if (has_span) throw CommandLineError("--from, --to, --speed", "are for videos");
    write_file(file, page_of_recording(arguments.recording));
    std::printf("page: %s, opens in any browser\n", file.c_str());
    return 0;
  }
  if (!VideoFile::knows(file))
    throw CommandLineError("file", arguments.file, "must end with .html, .gif, .webm, .mp4 or .webp");
  if (arguments.span.to <= arguments.span.from) throw CommandLineError("--to", "must be larger than --from");
  const int pictures = write_video(RecordedDrive(arguments.recording), arguments.span, file);
  std::printf("video: %s, %d pictures, %.1f s\n", file.c_str(), pictures, pictures / 25.0);
  return 0;
}

}  // namespace

void declare_export(Subcommand& command) {
  command.summary("Write a recording as one HTML file, or as a video from above");
  const auto arguments = std::make_shared<ExportArguments>();
  command.option("recording", arguments->recording, "Recording in MCAP", {.required = true});
  command.option(
      "file", arguments->file,
      "File to write: .html, which opens in any browser; or .gif, .webm, .mp4 or .webp, for which the "
      "program ffmpeg must be installed",
      {.required = true});
  command.option("--from", arguments->span.from, "Video: first second of the recording", {0, 1e6});
  command.option("--to", arguments->span.to, "Video: last second of the recording", {0, 1e6});
  command.option("--speed", arguments->span.speed, "Video: speed; 0.5 is slow motion", {0.01, 100});
  command.examples({"export lap.mcap lap.html", "export lap.mcap lap.webm --from 4 --to 8 --speed 0.5"});
  command.action([arguments, &command] {
    return export_recording(*arguments, !command.given_only({"recording", "file"}));
  });
}

}  // namespace slalom::tools
