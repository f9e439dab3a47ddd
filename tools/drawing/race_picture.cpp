#include "tools/drawing/race_picture.hpp"

#include "tools/command_line/words.hpp"
#include "tools/drawing/axis.hpp"
#include "tools/drawing/drawing.hpp"

namespace slalom::tools {
namespace {

using evaluation::RacingLap;
using evaluation::RacingSample;

constexpr Colour lap_colour{0.12, 0.42, 0.78, 1}, profile_colour{0.45, 0.48, 0.55, 1},
    beyond_colour{0.80, 0.13, 0.23, 1};
constexpr double width = 1240, height = 720, left = 64, right = 800, speed_top = 112, speed_bottom = 400,
                 delta_top = 456, delta_bottom = 660, circle_left = 876, circle_right = 1212,
                 circle_top = 112, circle_bottom = circle_top + circle_right - circle_left;
constexpr int delta_steps = 400;

void draw_frame(Pen& pen, const Axis& x, const Axis& y, const std::string& title, const std::string& below) {
  pen.text(x.from, y.to - 12, 14, title, ink, 0, true);
  for (const double tick : x.ticks) {
    pen.line(x(tick), y.from, x(tick), y.to, rule, 1);
    pen.text(x(tick), y.from + 17, 12, short_number(tick), faint_ink, 0.5);
  }
  for (const double tick : y.ticks) {
    pen.line(x.from, y(tick), x.to, y(tick), tick == 0 ? faint_ink : rule, 1);
    pen.text(x.from - 8, y(tick) + 4, 12, short_number(tick), faint_ink, 1);
  }
  pen.text(0.5 * (x.from + x.to), y.from + 36, 12.5, below, faint_ink, 0.5);
}

void draw_sectors(Pen& pen, const Axis& x, const Axis& y, double length) {
  for (int i = 1; i < evaluation::racing_sectors; ++i) {
    const double at = x(length * i / evaluation::racing_sectors);
    pen.line(at, y.from, at, y.to, faint_ink, 1, true);
  }
}

Pen::Points speeds(const RacingLap& lap, const Axis& x, const Axis& y) {
  Pen::Points points;
  for (const RacingSample& sample : lap.samples) points.emplace_back(x(sample.distance), y(sample.speed));
  return points;
}

void draw_speeds(Pen& pen, const RacePicture& picture, const Axis& x) {
  double fastest = 1;
  for (const RacingLap* lap : {&picture.lap.lap, &picture.profile.lap})
    for (const RacingSample& sample : lap->samples) fastest = std::max(fastest, sample.speed);
  const Axis y = linear_axis(0, fastest, speed_bottom, speed_top, 5);
  draw_frame(pen, x, y, "speed, m/s", "");
  draw_sectors(pen, x, y, picture.length);
  pen.stroke(speeds(picture.profile.lap, x, y), {profile_colour, 1.6, 5});
  pen.stroke(speeds(picture.lap.lap, x, y), {lap_colour, 2});
}

void draw_deltas(Pen& pen, const RacePicture& picture, const Axis& x) {
  std::vector<double> behind;
  double low = -0.01, high = 0.01;
  for (int i = 0; i <= delta_steps; ++i) {
    behind.push_back(evaluation::time_behind(picture.lap.lap.samples, picture.profile.lap.samples,
                                             picture.length * i / delta_steps));
    low = std::min(low, behind.back());
    high = std::max(high, behind.back());
  }
  const Axis y = linear_axis(low, high, delta_bottom, delta_top, 4);
  draw_frame(pen, x, y, "time of the lap minus time of the profile, s", "distance along the course, m");
  draw_sectors(pen, x, y, picture.length);
  Pen::Points points;
  for (int i = 0; i <= delta_steps; ++i)
    points.emplace_back(x(picture.length * i / delta_steps), y(behind[static_cast<std::size_t>(i)]));
  pen.stroke(points, {profile_colour, 1.6, 5});
}

void draw_circle(Pen& pen, const RacePicture& picture) {
  double most = picture.grip;
  for (const RacingSample& s : picture.lap.lap.samples)
    most = std::max({most, std::abs(s.lateral), std::abs(s.longitudinal)});
  most *= 1.05;
  // Lateral accelerations are positive to the left, and so they are drawn.
  Axis x = linear_axis(-most, most, circle_left, circle_right, 6, true);
  std::swap(x.low, x.high);
  const Axis y = linear_axis(-most, most, circle_bottom, circle_top, 6, true);
  draw_frame(pen, x, y, "acceleration, m/s\xC2\xB2", "to the left, m/s\xC2\xB2");
  Pen::Points circle;
  constexpr int corners = 180;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * 3.14159265358979323846 * i / corners;
    circle.emplace_back(x(picture.grip * std::cos(angle)), y(picture.grip * std::sin(angle)));
  }
  pen.stroke(circle, {faint_ink, 1.6}, true);
  for (std::size_t i = 1; i < picture.lap.lap.samples.size(); ++i) {
    const RacingSample& s = picture.lap.lap.samples[i];
    const bool beyond = std::hypot(s.longitudinal, s.lateral) > picture.grip;
    Colour colour = beyond ? beyond_colour : lap_colour;
    colour.opacity = 0.6;
    pen.disc(x(s.lateral), y(s.longitudinal), 2.4, colour);
  }
  const auto use = evaluation::grip_use(picture.lap.lap.samples, picture.grip);
  const std::string words = formatted("circle: %.2f m/s\xC2\xB2; %.1f %% of the time beyond it (red)",
                                      picture.grip, 100 * use.beyond);
  pen.text(circle_left, circle_bottom + 62, 12.5, words, faint_ink);
}

void draw_key(Pen& pen, const RacePicture& picture) {
  double x = left;
  const auto entry = [&](const std::string& name, const Stroke& stroke) {
    pen.stroke({{x, 71}, {x + 26, 71}}, stroke);
    pen.text(x + 33, 75, 13, name, ink);
    x += 33 + pen.text_width(name, 13) + 26;
  };
  entry(picture.lap.name, {lap_colour, 2});
  entry(picture.profile.name, {profile_colour, 1.6, 5});
}

}  // namespace

void draw_race(const RacePicture& picture, const std::filesystem::path& file) {
  const auto draw = [&](Pen& pen) {
    pen.text(left, 28, 18, picture.title, ink, 0, true);
    pen.text(left, 50, 13, picture.facts, faint_ink);
    draw_key(pen, picture);
    const Axis x = linear_axis(0, picture.length, left, right, 8, true);
    draw_speeds(pen, picture, x);
    draw_deltas(pen, picture, x);
    draw_circle(pen, picture);
  };
  save({width, height, draw}, file);
}

}  // namespace slalom::tools
