#include <charconv>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/evaluation/rooms/room_scenario.hpp"

namespace slalom::evaluation {

namespace {

constexpr maps::Point corner{-8, -1};                                // m, of the floor in the world's frame
constexpr double floor_length = 12, floor_width = 17;                // m
constexpr maps::Pose first_pose{-2.25, 3, 1.57};                     // m, m, rad, in the world's frame
constexpr double way = 10;                                           // m along y to the goal
constexpr double cell = 0.15;                                        // m, of the paths
constexpr double first_x = -0.075 - 30 * cell, first_y = 0.075 + 5;  // m, of cell (0, 0)
constexpr double optimal_speed = 2;                                  // m/s
constexpr int worlds = 300;
constexpr std::uint64_t most_bytes = 10'000'000;

/// The number after a word, from a place of a text on; moves the place behind it.
double number_after(const std::string& text, std::string_view word, std::size_t& at,
                    const std::string& file) {
  at = text.find(word, at);
  double value = 0;
  if (at != std::string::npos) {
    at += word.size();
    while (at < text.size() && text[at] == ' ') ++at;
    const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), value);
    if (error == std::errc()) {
      at = static_cast<std::size_t>(end - text.data());
      return value;
    }
  }
  throw IoError(file, 0, "must have a number after " + std::string(word));
}

/// The cylinders of a world.
std::vector<sim::Disc> posts_of(const std::string& text, const std::string& file) {
  std::vector<sim::Disc> posts;
  const std::size_t end = text.find("<state");  // poses of the same cylinders follow
  for (std::size_t at = 0; (at = text.find("<model name='unit_cylinder", at)) < end;) {
    const double x = number_after(text, "<pose frame=''>", at, file), y = number_after(text, "", at, file);
    posts.push_back({{x - corner.x, y - corner.y}, number_after(text, "<radius>", at, file)});
  }
  return posts;
}

/// The length (m) of the way from the start along a path of cells, in a file of numpy, to the goal.
double path_length(const std::string& bytes, const std::string& file) {
  constexpr std::size_t prefix = 10;
  if (bytes.size() < prefix || bytes.find("'<i8'") == std::string::npos)
    throw IoError(file, 0, "must be an array of numpy of 64-bit integers");
  const std::size_t header =
      static_cast<unsigned char>(bytes[8]) + 256U * static_cast<unsigned char>(bytes[9]);
  maps::Point before{first_pose.x, first_pose.y};
  double length = 0;
  const auto go = [&](const maps::Point& to) {
    length += std::hypot(to.x - before.x, to.y - before.y);
    before = to;
  };
  for (std::size_t at = prefix + header; at + 16 <= bytes.size(); at += 16) {
    std::int64_t cells[2];
    std::memcpy(cells, bytes.data() + at, sizeof cells);
    go({first_x + cell * static_cast<double>(cells[0]), first_y + cell * static_cast<double>(cells[1])});
  }
  go({first_pose.x, first_pose.y + way});
  return length;
}

}  // namespace

std::vector<RoomScenario> barn_scenarios(const std::filesystem::path& folder, int every) {
  std::vector<RoomScenario> scenarios;
  for (int i = 0; i < worlds; i += every) {
    const std::string number = std::to_string(i);
    const auto world = folder / ("world_" + number + ".world"),
               path = folder / "path_files" / ("path_" + number + ".npy");
    RoomScenario made{.name = "barn-" + number, .summary = "world " + number + " of BARN"};
    made.room.length = floor_length;
    made.room.width = floor_width;
    made.room.posts = posts_of(read_file(world, most_bytes), world.string());
    made.start = {first_pose.x - corner.x, first_pose.y - corner.y, first_pose.yaw};
    made.goal = {made.start.x, made.start.y + way, 0.5 * std::numbers::pi};
    made.base.max_forward = 2;
    made.base.delay_forward = made.base.delay_turn = made.lag = 0.15;
    made.robot_length = 0.508;
    made.robot_width = 0.43;
    made.padding = 0.03;
    made.beams = 960;
    made.view = 1.5 * std::numbers::pi;
    made.goal_reach = 1;
    made.optimal_time = path_length(read_file(path, most_bytes), path.string()) / optimal_speed;
    scenarios.push_back(std::move(made));
  }
  return scenarios;
}

}  // namespace slalom::evaluation
