#include "view/server/access.hpp"

namespace slalom::view {
namespace {

/// Compares in a time that does not depend on how many characters are right.
bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  int difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= a[i] ^ b[i];
  return difference == 0;
}

/// Whether a name in a request is one of this server. If the server can be reached from elsewhere, any name
/// may lead to it, and the token decides.
bool is_own_host(const ServerOptions& options, std::string_view host) {
  const bool is_v6 = host.starts_with('[');
  const std::string_view name = host.substr(0, is_v6 ? host.find(']') + 1 : host.find(':'));
  return !is_loopback(options.host) || name == "localhost" || name == "127.0.0.1" || name == "[::1]" ||
         name == options.host;
}

/// Whether a request comes from a page of this server. A browser always sends an Origin with a WebSocket; a
/// client that sends none is not a page of another site.
bool is_own_origin(std::string_view origin, std::string_view host) {
  return origin.empty() || origin == "http://" + std::string(host) ||
         origin == "https://" + std::string(host);
}

}  // namespace

std::string path_of(std::string_view target) {
  return std::string(target.substr(0, target.find('?')));
}

std::string_view query_value(std::string_view target, std::string_view key) {
  std::size_t at = target.find('?');
  while (at != std::string_view::npos) {
    const std::size_t end = target.find('&', at + 1);
    const std::string_view pair = target.substr(at + 1, end == std::string_view::npos ? end : end - at - 1);
    const std::size_t equals = pair.find('=');
    if (pair.substr(0, equals) == key && equals != std::string_view::npos) return pair.substr(equals + 1);
    at = end;
  }
  return {};
}

Verdict judge(const ServerOptions& options, const std::map<std::string, Resource>& resources,
              const Request& request, int clients) {
  // A second Host or Origin could hide the one that is checked.
  if (request.is_ambiguous) return {400, "Host and Origin must not be repeated\n"};
  if (!is_own_host(options, request.host)) return {403, "this host name is not served here\n"};
  if (!options.token.empty() && !same_secret(query_value(request.target, "token"), options.token))
    return {401, "open the printed address, which contains the token\n"};
  const std::string path = path_of(request.target);
  if (request.is_upgrade && path == "/ws") {
    if (!is_own_origin(request.origin, request.host))
      return {403, "pages of another origin are not served\n"};
    if (clients >= options.max_clients) return {503, "too many clients\n"};
    return {101};
  }
  if (request.method != "GET" && request.method != "HEAD") return {405, "only GET and HEAD are supported\n"};
  if (request.is_upgrade || !resources.contains(path)) return {404, "not found\n"};
  return {200};
}

}  // namespace slalom::view
