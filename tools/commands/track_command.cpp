#include <iostream>

#include "json/json.hpp"
#include "slalom/vehicle/course/track_generator.hpp"
#include "tools/command_line/words.hpp"
#include "tools/commands/commands.hpp"
#include "tools/drawing/course_pictures.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using vehicle::GeneratedTrack;
using vehicle::TrackGeneratorOptions;

struct TrackArguments {
  TrackGeneratorOptions options;
  std::string character = vehicle::name(TrackGeneratorOptions{}.character);
  std::optional<double> width, top_speed;
  std::string out, name, description, json;
  bool no_picture = false;
};

/// The command that generates the same track again. --out has only the last part of the path of the folder.
std::string command_of(const TrackArguments& arguments, const TrackGeneratorOptions& options) {
  std::string text = "slalom track --seed " + std::to_string(options.seed) + " --length " +
                     short_number(options.length) + " --width " + short_number(options.width) +
                     " --character " + arguments.character;
  if (arguments.top_speed) text += " --top-speed " + short_number(*arguments.top_speed);
  const std::string folder = folder_name(arguments.out);
  if (arguments.name != folder) text += " --name " + shell_word(arguments.name);
  if (!arguments.description.empty()) text += " --description " + shell_word(arguments.description);
  return text + " --out " + shell_word(folder);
}

Json summary_of(const GeneratedTrack& track, const TrackArguments& arguments, const std::string& command) {
  double slowest = track.raceline.front().speed, fastest = slowest, sharpest = 0;
  for (const auto& point : track.raceline) {
    slowest = std::min(slowest, point.speed);
    fastest = std::max(fastest, point.speed);
    sharpest = std::max(sharpest, std::abs(point.curvature));
  }
  return {
      {"name", arguments.name},
      {"folder", arguments.out},
      {"command", command},
      {"seed", track.options.seed},
      {"character", arguments.character},
      {"length_m", vehicle::path_length(track)},
      {"centre_line_length_m", track.options.length},
      {"width_m", track.options.width},
      {"raceline_least_radius_m", 1 / sharpest},
      {"slowest_mps", slowest},
      {"fastest_mps", fastest},
      {"profile_lap_s", track.lap_time},
      {"map",
       {{"width", track.map.width}, {"height", track.map.height}, {"resolution_m", track.map.resolution}}}};
}

void track(TrackArguments arguments) {
  TrackGeneratorOptions options = arguments.options;
  options.character =
      for_option("--character", [&] { return vehicle::track_character(arguments.character); });
  options.width = arguments.width.value_or(vehicle::usual_width(options.character));
  options.limits.top_speed = arguments.top_speed.value_or(vehicle::usual_top_speed(options.character));
  if (arguments.name.empty()) arguments.name = folder_name(arguments.out);
  const std::string command = command_of(arguments, options);

  const GeneratedTrack track = vehicle::generate_track(options);
  vehicle::save_track(track, arguments.out, {arguments.name, arguments.description, command});
  if (!arguments.no_picture) draw_track(track, arguments.name, fs::path(arguments.out) / "picture.png");

  const auto summary = summary_of(track, arguments, command);
  std::ostream& words = arguments.json == "-" ? std::cerr : std::cout;
  words << formatted("%s: %.1f m long, %.1f m wide, %.1f to %.1f m/s, profile lap %.1f s\n",
                     arguments.name.c_str(), vehicle::path_length(track), options.width,
                     summary["slowest_mps"].get<double>(), summary["fastest_mps"].get<double>(),
                     track.lap_time);
  words << "written to " << arguments.out << "\n";
  if (!arguments.json.empty()) write_json(summary, arguments.json);
}

}  // namespace

void declare_track(Subcommand& command) {
  command.summary("Generate a course: map, raceline with speeds, obstacle path, picture");
  const auto arguments = std::make_shared<TrackArguments>();
  TrackGeneratorOptions& options = arguments->options;
  command.option("--out", arguments->out, "Output folder; created if it does not exist", {.required = true});
  command.option("--seed", options.seed, "Seed; the same options and seed give the same files");
  command.option("--length", options.length, "Length of the centre line, m; the line to drive is shorter",
                 {20, 1000});
  command.option("--width", arguments->width, "Width from wall to wall, m [by character: 2.2, 2.6, 2.2, 1.5]",
                 {1.2, 10});
  command.option("--character", arguments->character, "balanced, fast, twisty or narrow");
  command.option("--top-speed", arguments->top_speed, "Maximum speed, m/s [by character: 6, 7, 5, 4.5]",
                 {0.5, 20});
  command.option("--name", arguments->name, "Name of the course [name of the folder]");
  command.option("--description", arguments->description, "Description for course.yaml");
  command.json(arguments->json, "a summary");
  command.flag("--no-picture", arguments->no_picture, "Do not write picture.png");
  command.examples({"track --seed 7 --length 60 --width 2.2 --out new_course",
                    "track --seed 3 --character twisty --out new_course"});
  command.action([arguments] {
    track(*arguments);
    return 0;
  });
}

}  // namespace slalom::tools
