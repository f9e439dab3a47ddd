#include "view_command.hpp"

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>

#include "interrupt.hpp"
#include "page_data.hpp"
#include "scenario.hpp"
#include "server.hpp"
#include "session.hpp"
#include "slalom/solvers/make_solver.hpp"
#include "slalom/vehicle/course.hpp"

namespace slalom::tools {
namespace {

struct Arguments {
  ScenarioArguments scenario;
  std::string method = "svg_mppi";
  std::uint64_t seed = 0;
  std::string host = "127.0.0.1";
  std::uint16_t port = 8400;
  std::string token;
};

std::string random_token() {
  std::random_device random;
  std::array<char, 33> text{};
  for (std::size_t i = 0; i < 4; ++i) std::snprintf(text.data() + 8 * i, 9, "%08x", random());
  return text.data();
}

/// The configurations that ship.
std::vector<std::string> configuration_names() {
  std::vector<std::string> names;
  for (const auto& root : vehicle::configuration_roots(program_folder()))
    for (const auto& entry : std::filesystem::directory_iterator(root))
      if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::string further_arguments(const ScenarioArguments& a) {
  std::string words;
  if (a.evaluation != "true") words += " --evaluation " + a.evaluation;
  if (!a.start.empty()) words += " --start " + a.start;
  if (a.latency_ms > 0) words += " --latency-ms " + nlohmann::json(a.latency_ms).dump();
  for (const std::string& each : a.set) words += " --set '" + each + "'";
  return words;
}

view::SessionOptions session_options(const Arguments& arguments) {
  view::SessionOptions options;
  options.scenario = {.course = arguments.scenario.course,
                      .method = arguments.method,
                      .config = arguments.scenario.config,
                      .seed = arguments.seed,
                      .obstacles = arguments.scenario.obstacles};
  options.load = [given = arguments.scenario](const view::ScenarioNames& names) {
    ScenarioArguments a = given;
    a.course = names.course;
    a.config = names.config;
    a.obstacles = names.obstacles;
    Scenario scenario = load_scenario(a, names.method);
    return view::LoadedScenario{scenario.arena, scenario.configuration, scenario.lap};
  };
  options.courses = vehicle::course_names(vehicle::course_roots(program_folder()));
  for (const char* name : solver_names()) options.methods.emplace_back(name);
  options.configurations = configuration_names();
  options.further_arguments = further_arguments(arguments.scenario);
  return options;
}

int run(const Arguments& arguments) {
  view::ServerOptions server_options;
  server_options.host = arguments.host;
  server_options.port = arguments.port;
  server_options.token = arguments.token;
  // Whoever can reach the machine could take the wheel; so whoever is not on it needs to know a secret.
  if (server_options.token.empty() && !view::is_loopback(arguments.host))
    server_options.token = random_token();
  view::Server server(server_options, {{"/", {"text/html; charset=utf-8", "gzip", view::page_gzip()}}});
  view::Session session(session_options(arguments), server);
  const InterruptFlag interrupt;
  const bool is_v6 = arguments.host.find(':') != std::string::npos;
  std::printf("http://%s:%u/%s\n", (is_v6 ? "[" + arguments.host + "]" : arguments.host).c_str(),
              static_cast<unsigned>(server.port()),
              server_options.token.empty() ? "" : ("?token=" + server_options.token).c_str());
  std::printf("open this address in a browser; Ctrl-C ends\n");
  std::fflush(stdout);
  session.run(interrupt.raised());
  return 0;
}

}  // namespace

CLI::App* add_view_command(CLI::App& app, int& exit_status) {
  CLI::App* command =
      app.add_subcommand("view", "Drive, and serve a page on which everything can be seen and touched");
  const auto arguments = std::make_shared<Arguments>();
  arguments->scenario.obstacles = 8;
  add_scenario_options(*command, arguments->scenario);
  add_method_option(*command, arguments->method);
  command->add_option("--seed", arguments->seed, "Of the drive")->capture_default_str();
  command
      ->add_option("--host", arguments->host,
                   "Address to listen on; others than this machine's own need the token")
      ->capture_default_str();
  command->add_option("--port", arguments->port, "0: any that is free")->capture_default_str();
  command->add_option("--token", arguments->token,
                      "Ask for this token; made at random where --host opens the view to others");
  command->callback([arguments, &exit_status] { exit_status = run(*arguments); });
  return command;
}

}  // namespace slalom::tools
