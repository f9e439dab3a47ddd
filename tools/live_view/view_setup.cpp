#include "tools/live_view/view_setup.hpp"

#include <cctype>
#include <random>

#include "json/json.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/vehicle/course/course.hpp"

namespace slalom::tools {
namespace {

/// The configurations that are installed.
std::vector<std::string> configuration_names() {
  std::vector<std::string> names;
  for (const auto& root : vehicle::configuration_roots(program_folder()))
    for (const auto& entry : list_folder(root))
      if (entry.extension() == ".yaml") names.push_back(entry.stem().string());
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::string random_token() {
  std::random_device random;
  std::array<char, 33> text{};
  for (std::size_t i = 0; i < 4; ++i) std::snprintf(text.data() + 8 * i, 9, "%08x", random());
  return text.data();
}

}  // namespace

view::Choices choices() {
  view::Choices choices{.courses = vehicle::course_names(vehicle::course_roots(program_folder()))};
  for (const char* name : solver_names()) choices.methods.emplace_back(name);
  choices.configurations = configuration_names();
  return choices;
}

std::string further_arguments(const ScenarioArguments& a) {
  std::string words;
  if (a.evaluation != "true") words += " --evaluation " + a.evaluation;
  if (!a.start.empty()) words += " --start " + a.start;
  if (a.latency_ms > 0) words += " --latency-ms " + Json(a.latency_ms).dump();
  for (const std::string& place : a.obstacle) words += " --obstacle " + place;
  for (const std::string& each : a.set) words += " --set '" + each + "'";
  return words;
}

view::ServerOptions server_options(const std::string& host, std::uint16_t port, const std::string& token) {
  // Unreserved characters (RFC 3986, section 2.3): browsers encode all others.
  const auto stands_for_itself = [](unsigned char c) {
    return (c < 128 && std::isalnum(c)) || c == '-' || c == '.' || c == '_' || c == '~';
  };
  if (!std::all_of(token.begin(), token.end(), stands_for_itself))
    throw CommandLineError("--token", token, "must have only letters, digits and - . _ ~");
  return {.host = host,
          .port = port,
          .ports = 10,
          .token = token.empty() && !view::is_loopback(host) ? random_token() : token};
}

}  // namespace slalom::tools
