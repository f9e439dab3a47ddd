#pragma once

#include <string>
#include <string_view>

#include "view/server/server.hpp"

namespace slalom::view {

/// The parts of an HTTP request that decide on its answer; header fields are empty if absent.
struct Request {
  std::string_view method, target, host, origin;
  bool is_upgrade = false;    ///< asks for a WebSocket
  bool is_ambiguous = false;  ///< has several fields Host or Origin
};

/// The status of the answer to a request, and the reason if it is refused.
struct Verdict {
  unsigned status = 200;  ///< status of HTTP; 101: the connection becomes a WebSocket
  std::string_view reason{};
};

/// Decides who may have what: host name, token and origin must be those of this server, and the path must be
/// one of `resources`, or /ws for a WebSocket. `clients`: number of open WebSockets.
Verdict judge(const ServerOptions& options, const std::map<std::string, Resource>& resources,
              const Request& request, int clients);

/// The path of a target, without its query.
std::string path_of(std::string_view target);
/// The value of a key in the query of a target; empty if there is none.
std::string_view query_value(std::string_view target, std::string_view key);

}  // namespace slalom::view
