#pragma once

#include "tools/scenario/scenario.hpp"
#include "view/protocol/messages.hpp"
#include "view/server/server.hpp"

/// The description of a scenario in the live view and in recordings.
namespace slalom::tools {

/// The available courses, methods and configurations.
view::Choices choices();

/// The command-line arguments besides course, method, configuration, seed and obstacles; begins with a space.
std::string further_arguments(const ScenarioArguments& arguments);

/// The address to listen on. Everybody who can reach the server can control the drive; so other machines need
/// a token, which is random if none is given. Throws IoError where an address cannot hold the token.
view::ServerOptions server_options(const std::string& host, std::uint16_t port, const std::string& token);

}  // namespace slalom::tools
