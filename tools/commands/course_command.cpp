#include <iostream>

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/maps/ros_map.hpp"
#include "slalom/vehicle/course/track_generator.hpp"
#include "slalom/vehicle/racing/race_course.hpp"
#include "tools/command_line/words.hpp"
#include "tools/commands/commands.hpp"
#include "tools/drawing/course_pictures.hpp"
#include "tools/recording/driven_recording.hpp"
#include "tools/scenario/scenario.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using vehicle::RaceCourse;
using vehicle::RacingCar;

struct CourseArguments {
  std::string input, line, car = RacingCar{}.name, start, out, name, description, json;
  std::optional<double> friction, top_speed, margin, narrowest;
  bool reverse = false, no_picture = false;
};

RacingCar chosen_car(const CourseArguments& arguments) {
  RacingCar car = find_racing_car(arguments.car);
  if (arguments.friction) vehicle::set_friction(car, *arguments.friction);
  if (arguments.top_speed) car.limits.top_speed = *arguments.top_speed;
  if (arguments.margin) car.margin = *arguments.margin;
  vehicle::validate(car);
  return car;
}

bool is_csv(const std::string& file) {
  return fs::path(file).extension() == ".csv";
}

/// A line to drive along: a CSV file or a recording.
vehicle::GuideLine read_guide(const std::string& file) {
  return is_csv(file) ? vehicle::read_centre_line(file).line : driven_line(file);
}

RaceCourse make_course(const CourseArguments& arguments, const RacingCar& car) {
  vehicle::RaceCourseOptions options{.reverse = arguments.reverse,
                                     .narrowest = arguments.narrowest.value_or(0)};
  if (!arguments.start.empty()) options.start = parse_pose("--start", arguments.start);
  if (!is_csv(arguments.input)) {
    std::vector<std::string> notes;
    const auto map = maps::load_ros_map(arguments.input, maps::MapRule::map_server, &notes);
    std::optional<vehicle::GuideLine> guide;
    if (!arguments.line.empty()) guide = read_guide(arguments.line);
    if (guide && !guide->note.empty()) notes.push_back(arguments.line + ": " + guide->note);
    RaceCourse course = vehicle::race_course(map, car, options, guide ? &*guide : nullptr);
    course.notes.insert(course.notes.begin(), notes.begin(), notes.end());
    return course;
  }
  if (!arguments.line.empty())
    throw CommandLineError("--line", "needs a map; " + arguments.input + " is a centre line");
  const auto read = vehicle::read_centre_line(arguments.input);
  if (read.left.empty())
    throw IoError(arguments.input, 0, "has no widths; give a map, and this file as --line");
  const double step = centre_line_step(car, vehicle::length({read.line.points, {}, {}, {}, false}));
  RaceCourse made = vehicle::race_course(
      vehicle::corridor_from_widths(read.line.points, read.left, read.right, read.line.closed, step), car,
      options);
  if (!read.line.note.empty()) made.notes.push_back(arguments.input + ": " + read.line.note);
  return made;
}

/// The command that makes the same course again.
std::string command_of(const CourseArguments& arguments) {
  std::string text = "slalom course " + shell_word(arguments.input);
  const auto add = [&](const char* flag, const std::string& value) {
    if (!value.empty()) text += std::string(" ") + flag + " " + shell_word(value);
  };
  const auto add_number = [&](const char* flag, const std::optional<double>& value) {
    if (value) add(flag, short_number(*value));
  };
  add("--line", arguments.line);
  if (arguments.car != RacingCar{}.name) add("--car", arguments.car);
  add_number("--friction", arguments.friction);
  add_number("--top-speed", arguments.top_speed);
  add_number("--margin", arguments.margin);
  add_number("--narrowest", arguments.narrowest);
  add("--start", arguments.start);
  if (arguments.reverse) text += " --reverse";
  add("--out", folder_name(arguments.out));
  return text;
}

Json summary_of(const RaceCourse& course, const RacingCar& car, const CourseArguments& arguments) {
  const auto& points = course.raceline.points;
  const auto [slowest, fastest] = std::minmax_element(
      points.begin(), points.end(), [](const auto& a, const auto& b) { return a.speed < b.speed; });
  double sharpest = 0, narrowest = 1e300;
  for (const auto& point : points) sharpest = std::max(sharpest, std::abs(point.curvature));
  for (std::size_t i = 0; i < course.corridor.left.size(); ++i)
    narrowest = std::min(narrowest, course.corridor.left[i] + course.corridor.right[i]);
  const auto nearest = std::min_element(course.distance.begin(), course.distance.end());
  const auto& tightest = points[static_cast<std::size_t>(nearest - course.distance.begin())];
  Json summary = {{"name", arguments.name},
                  {"folder", arguments.out},
                  {"car", car.name},
                  {"closed", course.corridor.closed},
                  {"length_m", course.raceline.length},
                  {"centre_line_length_m", vehicle::length(course.corridor)},
                  {"narrowest_m", narrowest},
                  {"profile_lap_s", course.raceline.time},
                  {"slowest_mps", slowest->speed},
                  {"fastest_mps", fastest->speed},
                  {"max_curvature_per_m", sharpest},
                  {"car_curvature_per_m", vehicle::max_curvature(car)},
                  {"min_clearance_m", *nearest - 0.5 * car.width},
                  {"min_clearance_at", {tightest.x, tightest.y}},
                  {"start", {course.start.x, course.start.y, course.start.yaw}},
                  {"notes", Json::array()}};
  for (const std::string& note : course.notes) summary["notes"].push_back(note);
  return summary;
}

void course(CourseArguments arguments) {
  const RacingCar car = chosen_car(arguments);
  if (arguments.name.empty()) arguments.name = folder_name(arguments.out);
  const RaceCourse course = [&] {
    try {
      return make_course(arguments, car);
    } catch (const std::invalid_argument& error) {
      throw IoError(arguments.input, 0, error.what());
    }
  }();
  vehicle::save_race_course(course, arguments.out,
                            {arguments.name, arguments.description, command_of(arguments)});
  if (!arguments.no_picture)
    draw_course(course, car, arguments.name, fs::path(arguments.out) / "picture.png");
  const Json summary = summary_of(course, car, arguments);
  std::ostream& words = arguments.json == "-" ? std::cerr : std::cout;
  for (const std::string& note : course.notes) words << "note: " << note << "\n";
  words << formatted(
      "%s: %.1f m long, %.2f m wide at least, %s %.2f s at %.1f to %.1f m/s, radius %.2f m at least, "
      "%.2f m from body to wall\n",
      arguments.name.c_str(), course.raceline.length, summary["narrowest_m"].get<double>(),
      course.corridor.closed ? "lap" : "drive", course.raceline.time, summary["slowest_mps"].get<double>(),
      summary["fastest_mps"].get<double>(), 1 / std::max(summary["max_curvature_per_m"].get<double>(), 1e-9),
      summary["min_clearance_m"].get<double>());
  words << "written to " << arguments.out << "\n";
  if (!arguments.json.empty()) write_json(summary, arguments.json);
}

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

void declare_course(Subcommand& command) {
  command.summary("Make a course from a map: corridor, centre line, minimum-time raceline, picture");
  const auto arguments = std::make_shared<CourseArguments>();
  command.option("input", arguments->input,
                 "Map (ROS YAML file), or a centre line with widths (.csv), from which a map is drawn",
                 {.required = true});
  command.option("--out", arguments->out, "Output folder; created if it does not exist", {.required = true});
  command.option(
      "--line", arguments->line,
      "Line to drive along: .csv with x and y, or a recorded drive; else the program finds a loop");
  command.option("--car", arguments->car, car_help);
  command.option("--friction", arguments->friction,
                 "Friction coefficient: acceleration in every direction, in g", {0.01, 10});
  command.option("--top-speed", arguments->top_speed, "Maximum speed, m/s", {0.1, 200});
  command.option("--margin", arguments->margin,
                 "Distance that the body keeps from walls, m; in narrow places less, down to 0.4 of it",
                 {0, 10});
  command.option("--narrowest", arguments->narrowest, "Least width of the gaps that a found loop may use, m",
                 {0, 1000});
  command.option("--start", arguments->start,
                 "Start pose x,y,yaw, m, m, rad; it sets the direction [the origin of the map frame, if "
                 "the course passes it along +x]");
  command.flag("--reverse", arguments->reverse, "Drive the other way round", {.excludes = {"--start"}});
  command.option("--name", arguments->name, "Name of the course [name of the folder]");
  command.option("--description", arguments->description, "Description for course.yaml");
  command.json(arguments->json, "a summary");
  command.flag("--no-picture", arguments->no_picture, "Do not write picture.png");
  command.examples({"course map.yaml --out my_course",
                    "course map.yaml --car my_car.yaml --line lap.mcap --out my_course"});
  command.action([arguments] {
    course(*arguments);
    return 0;
  });
}

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
