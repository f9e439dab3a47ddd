#pragma once

#include <string_view>

#include "view/server/server_state.hpp"

namespace slalom::view {

/// The parts of an HTTP request that decide on its answer.
struct Request {
  std::string_view method, target;
  std::string_view host, origin, accept_encoding;  ///< header fields; empty if absent
  bool is_upgrade = false;                         ///< asks for a WebSocket
  bool is_ambiguous = false;                       ///< has several fields Host or Origin
};

/// The answer to a request.
struct Answer {
  unsigned status = 200;               ///< status of HTTP; 101 if the connection becomes a WebSocket
  const Resource* resource = nullptr;  ///< the body if the status is 200
  bool encoded = false;                ///< the body is sent in the encoding of the resource
  std::string_view reason{};           ///< the body if the request is refused
  bool acknowledges = false;           ///< a WebSocket whose client acknowledges frames
};

/// Decides who may have what: host name, token and origin must be those of this server, and the path must
/// exist. Counts refused requests.
Answer answer_to(ServerState& state, const Request& request);

}  // namespace slalom::view
