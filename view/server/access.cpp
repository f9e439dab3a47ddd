#include "view/server/access.hpp"

#include <algorithm>
#include <string>

namespace slalom::view {
namespace {

/// Compares in a time that does not depend on how many characters are right.
bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  return difference == 0;
}

/// The value of a key in the query of a target; empty if there is none.
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

/// A host without its port.
std::string_view host_name(std::string_view host) {
  if (!host.empty() && host.front() == '[') return host.substr(0, host.find(']') + 1);
  return host.substr(0, host.find(':'));
}

/// If the server can be reached from elsewhere, any name may lead to it, and the token decides.
bool is_own_host(const ServerState& state, std::string_view host) {
  const std::string_view name = host_name(host);
  return !state.loopback || name == "localhost" || name == "127.0.0.1" || name == "[::1]" ||
         name == state.options.host;
}

/// A browser always sends an Origin; a client that sends none is not a page of another site.
bool is_own_origin(std::string_view origin, std::string_view host) {
  return origin.empty() || origin == "http://" + std::string(host) ||
         origin == "https://" + std::string(host);
}

/// Whether a list such as "br, gzip;q=0.8" has an encoding with a weight above zero.
bool accepts(std::string_view list, std::string_view encoding) {
  const auto trimmed = [](std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t");
    return first == std::string_view::npos ? ""
                                           : text.substr(first, text.find_last_not_of(" \t") - first + 1);
  };
  while (!list.empty()) {
    const std::string_view item = list.substr(0, list.find(','));
    list.remove_prefix(std::min(list.size(), item.size() + 1));
    const std::string_view name = trimmed(item.substr(0, item.find(';')));
    if (name != encoding && name != "*") continue;
    const std::size_t weight = item.find("q=");
    // A weight of zero has no digit but zeros.
    return weight == std::string_view::npos ||
           item.find_first_of("123456789", weight) != std::string_view::npos;
  }
  return false;
}

Answer refuse(std::atomic<std::uint64_t>& counter, unsigned status, std::string_view reason) {
  ++counter;
  return {.status = status, .reason = reason};
}

Answer answer_to_upgrade(ServerState& state, const Request& request) {
  AtomicCounters& counters = state.counters;
  if (!is_own_origin(request.origin, request.host))
    return refuse(counters.refused_origin, 403, "pages of another origin are not served\n");
  if (state.clients.size() >= state.options.max_clients)
    return refuse(counters.refused_other, 503, "too many clients\n");
  return {.status = 101, .acknowledges = query_value(request.target, "acknowledge") == "1"};
}

}  // namespace

Answer answer_to(ServerState& state, const Request& request) {
  AtomicCounters& counters = state.counters;
  // A second Host or Origin could hide the one that is checked.
  if (request.is_ambiguous)
    return refuse(counters.refused_other, 400, "Host and Origin must not be repeated\n");
  if (!is_own_host(state, request.host))
    return refuse(counters.refused_origin, 403, "this host name is not served here\n");
  const std::string& token = state.options.token;
  if (!token.empty() && !same_secret(query_value(request.target, "token"), token))
    return refuse(counters.refused_token, 401, "open the printed address, which contains the token\n");
  const std::string path(request.target.substr(0, request.target.find('?')));
  if (request.is_upgrade && path == "/ws") return answer_to_upgrade(state, request);
  if (request.method != "GET" && request.method != "HEAD")
    return refuse(counters.refused_other, 405, "only GET and HEAD are supported\n");
  const auto found = state.resources.find(path);
  if (request.is_upgrade || found == state.resources.end())
    return refuse(counters.refused_other, 404, "not found\n");
  const Resource& resource = found->second;
  const bool encoded = !resource.encoding.empty() && accepts(request.accept_encoding, resource.encoding);
  return {.status = 200, .resource = &resource, .encoded = encoded};
}

}  // namespace slalom::view
