#include "tools/commands/navigate_report.hpp"

#include <cmath>
#include <filesystem>
#include <numbers>

#include "tools/drawing/map_picture.hpp"

namespace slalom::tools {
namespace {

using evaluation::RoomDrive;
using evaluation::RoomScenario;

constexpr int moment_interval = 3;  // s
constexpr Colour person_fill = {0.93, 0.75, 0.25, 0.55}, person_rim = {0.55, 0.40, 0.05, 1};

std::vector<maps::Point> outline(const maps::Pose& pose, const RoomScenario& scenario) {
  const auto corners = sim::corners({pose, scenario.robot_length, scenario.robot_width});
  return {corners.begin(), corners.end()};
}

std::vector<maps::Point> circle(const maps::Point& middle, double radius) {
  std::vector<maps::Point> points;
  constexpr int corners = 24;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    points.push_back({middle.x + radius * std::cos(angle), middle.y + radius * std::sin(angle)});
  }
  return points;
}

/// Draws robot and people of a drive, every moment_interval.
void draw_moments(MapPicture& picture, const RoomDrive& drive, const RoomScenario& scenario,
                  const Colour& colour) {
  const auto periods = static_cast<std::size_t>(std::lround(moment_interval / evaluation::room_period));
  for (std::size_t k = 0; k < drive.people.size(); ++k)
    picture.line(drive.people[k], person_rim, 2, false, true);
  if (drive.people.empty()) return;
  for (std::size_t i = 0; i < drive.trace.size(); i += periods) {
    picture.line(outline(drive.trace[i], scenario), colour, 1.5, true);
    for (std::size_t k = 0; k < drive.people.size(); ++k)
      picture.polygon(circle(drive.people[k][i], scenario.walkers[k].radius), person_fill, person_rim);
  }
}

}  // namespace

void draw(const std::vector<RoomSeries>& all, const RoomScenario& scenario, const std::string& folder) {
  MapPicture picture(sim::map_of(scenario.room, 0.05));
  for (const sim::Box& box : scenario.room.obstacles) {
    const auto corners = sim::corners(box);
    picture.polygon({corners.begin(), corners.end()}, {0.55, 0.58, 0.63, 1}, {0.3, 0.33, 0.38, 1});
  }
  for (const sim::Disc& post : scenario.room.posts)
    picture.polygon(circle(post.middle, post.radius), {0.55, 0.58, 0.63, 1}, {0.3, 0.33, 0.38, 1});
  std::vector<std::pair<std::string, Colour>> key;
  std::size_t index = 0;
  for (const RoomSeries& series : all) {
    if (series.scenario != &scenario) continue;
    Colour colour = method_colour(series.driver);
    colour.opacity = 0.75;
    ++index;
    key.emplace_back(series.driver, colour);
    for (const RoomDrive& drive : series.drives) {
      if (index == 1 && &drive == &series.drives.front()) draw_moments(picture, drive, scenario, colour);
      std::vector<maps::Point> points;
      for (const maps::Pose& pose : drive.trace) points.push_back({pose.x, pose.y});
      picture.line(points, colour, 3, false);
      picture.line(outline(drive.trace.back(), scenario), colour, 2, true);
      if (index == 1) picture.arrow(drive.goal, 20, {0.13, 0.16, 0.22, 1});
    }
  }
  if (!scenario.walkers.empty())
    key.emplace_back("people, every " + std::to_string(moment_interval) + " s", person_rim);
  picture.arrow(scenario.start, 20, {0.13, 0.16, 0.22, 1});
  picture.key(scenario.name, scenario.summary, key);
  picture.save(std::filesystem::path(folder) / (scenario.name + ".png"));
}

}  // namespace slalom::tools
