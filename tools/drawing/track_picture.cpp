#include "tools/drawing/track_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tools/drawing/map_picture.hpp"

namespace slalom::tools {

void draw_track(const vehicle::GeneratedTrack& track, const std::string& title,
                const std::filesystem::path& file) {
  MapPicture picture(track.map);
  std::vector<maps::Point> points;
  std::vector<double> speeds;
  for (const auto& point : track.raceline) {
    points.push_back({point.x, point.y});
    speeds.push_back(point.speed);
  }
  const auto [slow, fast] = std::minmax_element(speeds.begin(), speeds.end());
  const double slowest = std::floor(2 * *slow) / 2, fastest = std::ceil(2 * *fast) / 2;

  picture.line(track.centre_line, {0.62, 0.66, 0.73, 0.8}, 2, true, true);
  picture.speed_line(points, speeds, slowest, fastest, 7, true);

  const auto& start = track.raceline.front();
  const maps::Point foot = track.centre_line.front();
  const double half = 0.5 * track.options.width, across_x = -std::sin(start.yaw),
               across_y = std::cos(start.yaw);
  picture.line({{foot.x - half * across_x, foot.y - half * across_y},
                {foot.x + half * across_x, foot.y + half * across_y}},
               {0.13, 0.16, 0.22, 1}, 4, false);
  picture.arrow({start.x, start.y, start.yaw}, 20, {0.13, 0.16, 0.22, 1});

  char facts[160];
  std::snprintf(facts, sizeof facts,
                "%s, seed %llu \xC2\xB7 %.0f m long, %.1f m wide \xC2\xB7 profile lap %.1f s",
                vehicle::name(track.options.character), static_cast<unsigned long long>(track.options.seed),
                track.options.length, track.options.width, track.lap_time);
  picture.legend(title, facts, slowest, fastest);
  picture.save(file);
}

}  // namespace slalom::tools
