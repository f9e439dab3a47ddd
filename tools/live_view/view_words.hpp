#pragma once

#include <string>

#include "tools/scenario/scenario.hpp"
#include "view/protocol/messages.hpp"
#include "view/server/server.hpp"

/// What the live view and its recordings say of a scenario.
namespace slalom::tools {

/// The courses, methods and configurations that are known here.
view::Choices choices();
/// The place of a method among them.
int method_index(const view::Choices& choices, const std::string& method);

/// What a command line says besides course, method, configuration, seed and obstacles; begins with a space.
std::string further_arguments(const ScenarioArguments& arguments);

/// Where to listen. Whoever can reach the machine could take the wheel; so whoever is not on it needs to know
/// a token, made at random if none is given. Throws IoError where an address cannot hold the token.
view::ServerOptions server_options(const std::string& host, std::uint16_t port, const std::string& token);
/// Tells the user where the page is.
void print_address(const view::Server& server, const view::ServerOptions& options);

}  // namespace slalom::tools
