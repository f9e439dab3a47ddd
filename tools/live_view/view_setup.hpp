#pragma once

#include "slalom/view/subject.hpp"
#include "tools/scenario/scenario.hpp"
#include "view/protocol/messages.hpp"
#include "view/server/server.hpp"

/// The description of a scenario in the live view and in recordings.
/// The problems that `slalom view` shows beside a car.
namespace slalom::tools {

/// The available courses, methods and configurations.
view::Choices choices();

/// The command-line arguments besides course, method, configuration, seed and obstacles; begins with a space.
std::string further_arguments(const ScenarioArguments& arguments);

/// The address to listen on. Everybody who can reach the server can control the drive; so other machines need
/// a token, which is random if none is given. Throws IoError where an address cannot hold the token.
view::ServerOptions server_options(const std::string& host, std::uint16_t port, const std::string& token);

/// Returns a problem with a method that solves it with its default options, and its drawing. Throws
/// std::invalid_argument, which lists the names, if there is none of that name.
std::unique_ptr<view::SolverSubject> problem_subject(const std::string& name, const std::string& method,
                                                     std::uint64_t seed);

/// Returns a scenario of `slalom navigate` with its navigator: obstacles and goal can be dragged. Throws
/// std::invalid_argument, which lists the names, if there is no scenario or method of that name.
std::unique_ptr<view::SolverSubject> room_subject(const std::string& scenario, const std::string& method,
                                                  std::uint64_t seed);

}  // namespace slalom::tools
