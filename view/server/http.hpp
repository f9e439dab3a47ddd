#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "view/server/server.hpp"

namespace slalom::view {

/// The head of an HTTP request (RFC 9112).
struct HttpRequest {
  std::string method, target;
  std::map<std::string, std::string> fields;  ///< by their names in lower case

  /// The target without its query.
  std::string path() const { return target.substr(0, target.find('?')); }
  /// The value of a key of the query; empty if there is none.
  std::string_view query(std::string_view key) const;
  /// Empty if there is none.
  std::string_view field(const std::string& name) const;
  /// Whether it asks for a WebSocket.
  bool is_upgrade() const;
};

/// Reads a head, up to and without its empty line. Nothing if it is malformed.
std::optional<HttpRequest> parse_request(std::string_view head);

/// An answer with a body, after which the connection is closed; without its body if `head_only`.
std::string http_response(std::string_view status, const Resource& resource, bool head_only);

}  // namespace slalom::view
