#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "view/server/clients.hpp"
#include "view/server/counters.hpp"
#include "view/server/inbox.hpp"
#include "view/server/server.hpp"

namespace slalom::view {

/// The state that the connections of a server share. Options and resources do not change; counters and inbox
/// may be used from any thread, the rest from the server's thread only.
struct ServerState {
  const ServerOptions options;
  const std::map<std::string, Resource> resources;
  const bool loopback = is_loopback(options.host);  ///< can be reached from this machine only
  AtomicCounters counters{};
  Inbox inbox{counters};
  Clients clients{};
  int open_connections = 0;
  std::uint64_t next_client = 1;
};

}  // namespace slalom::view
