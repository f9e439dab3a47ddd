
#include "slalom/core/version.hpp"
#include "slalom/view/serve.hpp"
#include "tools/commands/commands.hpp"
#include "tools/live_view/view_setup.hpp"
#include "tools/scenario/scenario.hpp"
#include "tools/terminal/interrupt.hpp"
#include "view/car/car_subject.hpp"
#include "view/embedded.hpp"
#include "view/recording/drive_files.hpp"
#include "view/server/server.hpp"
#include "view/session/session.hpp"

namespace slalom::tools {
namespace {

struct ViewArguments {
  ScenarioArguments scenario;
  std::string method = "svg_mppi";
  std::uint64_t seed = 0;
  std::string host = "127.0.0.1";
  std::uint16_t port = 8400;
  std::string token, against, problem, room;
  bool record_all = false, record_times = false;
};

/// A scenario in which MPPI averages two ways around a parked car and SVG-MPPI commits to one: the program of
/// the paper, and a car in the middle of a straight.
void set_introduction(ViewArguments& arguments) {
  arguments.scenario.course = "stag";
  arguments.scenario.config = "published";
  arguments.scenario.obstacles = 1;
  arguments.seed = 77;
  arguments.against = "mppi";
}

view::SessionOptions session_options(const ViewArguments& arguments) {
  view::SessionOptions options;
  options.scenario = {.course = arguments.scenario.course,
                      .method = arguments.method,
                      .config = arguments.scenario.config,
                      .seed = arguments.seed,
                      .obstacles = arguments.scenario.obstacles,
                      .opponents = arguments.scenario.opponents};
  options.load = [given = arguments.scenario](view::ScenarioNames& names) {
    ScenarioArguments a = given;
    a.course = names.course;
    a.config = names.config;
    a.obstacles = names.obstacles;
    a.obstacle.resize(std::min(a.obstacle.size(), static_cast<std::size_t>(names.obstacles)));
    a.opponents = names.opponents;
    const Scenario scenario = load_scenario(a, names.method);
    names = view::with_course(names, *scenario.environment);
    return view::car_subject({scenario.environment, {scenario.configuration, names.method}, scenario.lap},
                             names.seed);
  };
  options.choices = choices();
  options.against = arguments.against;
  options.introduction = true;
  options.further_arguments = further_arguments(arguments.scenario);
  view::add_files(options, {.program = std::string("slalom ") + version(),
                            .everything = arguments.record_all,
                            .wall_clock = arguments.record_times});
  return options;
}

/// Returns the page of the introduction, which is made once: a recording of its first 1.75 s.
const std::string& introduction_page() {
  static std::string page;
  if (!page.empty()) return page;
  ViewArguments arguments;
  set_introduction(arguments);
  view::Server nobody({}, {});
  view::SessionOptions options = session_options(arguments);
  auto subject = options.load(options.scenario);
  view::StoredDrive drive = view::Session(std::move(subject), nobody, std::move(options)).record(70);
  drive.ticks.erase(drive.ticks.begin(), drive.ticks.begin() + 34);  // nothing is near yet
  page = view::replay_page(drive, true);
  return page.insert(page.find("<meta"), "<meta name=\"introduction\" />");
}

int view(const ViewArguments& arguments, bool begins_with_introduction) {
  view::ServerOptions address = server_options(arguments.host, arguments.port, arguments.token);
  if (!arguments.room.empty() || !arguments.problem.empty()) address.framed_by = view::notebooks;
  const std::string html = "text/html; charset=utf-8";
  view::Server server(address, {{"/", {html, view::page_html(), view::page_gzip()}},
                                {"/introduction", {.type = html, .body = {}, .later = introduction_page}}});
  view::SessionOptions options{.against = arguments.against, .introduction = true};
  std::unique_ptr<view::Subject> subject;
  if (!arguments.room.empty()) {
    subject =
        for_option("--room", [&] { return room_subject(arguments.room, arguments.method, arguments.seed); });
  } else if (!arguments.problem.empty()) {
    subject = problem_subject(arguments.problem, arguments.method, arguments.seed);
  } else {
    options = session_options(arguments);
    subject = options.load(options.scenario);
  }
  view::Session session(std::move(subject), server, std::move(options));
  const InterruptFlag interrupt;
  view::print_address(view::address_of(server, address, begins_with_introduction ? "/introduction" : "/"));
  while (!interrupt.raised()) session.turn(std::chrono::milliseconds(50));
  return 0;
}

}  // namespace

void declare_view(Subcommand& command) {
  command.summary("Drive and serve an interactive page in the browser");
  const auto arguments = std::make_shared<ViewArguments>();
  arguments->scenario.obstacles = 8;
  add_scenario_options(command, arguments->scenario);
  add_method_option(command, arguments->method);
  command.option("--seed", arguments->seed, "Seed of the drive");
  command.option("--against", arguments->against, "Second method, driven as a ghost with the same seed");
  command.option(
      "--problem", arguments->problem,
      "Show a problem that is not a car: pendulum, cart_pole, differential_drive, quadrotor or arm");
  command.option(
      "--room", arguments->room,
      "Show the navigator of a mobile robot in a scenario of slalom navigate, such as crowd-crossing");
  command.flag("--record-all", arguments->record_all,
               "Recordings and replays that the page saves have all candidates, guides and cost maps");
  command.flag("--record-times", arguments->record_times,
               "Recordings saved from the page contain wall-clock times");
  command.option("--host", arguments->host,
                 "Address to listen on; addresses other than loopback require a token");
  command.option("--port", arguments->port,
                 "Port to listen on, or one of the next nine; 0 means any free port");
  command.option("--token", arguments->token,
                 "Token that the page must present; random if --host is not a loopback address");
  command.examples(
      {"view", "view --course fox --against mppi --obstacles 5", "view --problem quadrotor --against mppi",
       "view --room crowd-crossing"},
      "Without options of the scenario, it prints the address of an introduction: svg_mppi and mppi side by "
      "side on the same seed before a parked car, recorded and explained.");
  command.action([arguments, &command] {
    for (const auto& [name, value] :
         {std::pair("--problem", arguments->problem), {"--room", arguments->room}}) {
      if (value.empty()) continue;
      if (!command.given_only({name, "--method", "--against", "--seed", "--host", "--port", "--token"}))
        throw CommandLineError(name,
                               "has only --method, --against, --seed, --host, --port and --token beside it");
      return view(*arguments, false);
    }
    const bool is_new =
        command.given_only({"--host", "--port", "--token", "--record-all", "--record-times", "--threads"});
    if (is_new) set_introduction(*arguments);
    ScenarioArguments& scenario = arguments->scenario;
    if (!scenario.obstacle.empty() && !command.given("--obstacles"))
      scenario.obstacles = static_cast<int>(scenario.obstacle.size());
    return view(*arguments, is_new);
  });
}

}  // namespace slalom::tools
