#include "view/server/http.hpp"

#include <algorithm>
#include <cctype>

namespace slalom::view {
namespace {

std::string lower_case(std::string_view text) {
  std::string made(text);
  for (char& c : made) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return made;
}

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Whether a list separated by commas has an element, in any case.
bool lists(std::string_view list, std::string_view element) {
  while (true) {
    const auto comma = list.find(',');
    if (lower_case(trimmed(list.substr(0, comma))) == element) return true;
    if (comma == std::string_view::npos) return false;
    list.remove_prefix(comma + 1);
  }
}

bool is_token(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) ||
           std::string_view("!#$%&'*+-.^_`|~").find(static_cast<char>(c)) != std::string_view::npos;
  });
}

bool is_printable(std::string_view text) {
  return std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return (c >= 32 && c != 127) || c == 9; });
}

/// Takes the part before `separator` off the front of a text.
std::string_view take_until(std::string_view& text, std::string_view separator) {
  const auto end = text.find(separator);
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + separator.size());
  return part;
}

}  // namespace

std::string_view HttpRequest::query(std::string_view key) const {
  std::string_view rest = target;
  take_until(rest, "?");
  while (!rest.empty()) {
    const std::string_view pair = take_until(rest, "&");
    const auto equals = pair.find('=');
    if (equals != std::string_view::npos && pair.substr(0, equals) == key) return pair.substr(equals + 1);
  }
  return {};
}

std::string_view HttpRequest::field(const std::string& name) const {
  const auto found = fields.find(name);
  return found == fields.end() ? std::string_view() : std::string_view(found->second);
}

bool HttpRequest::is_upgrade() const {
  return method == "GET" && lists(field("connection"), "upgrade") && lists(field("upgrade"), "websocket");
}

std::optional<HttpRequest> parse_request(std::string_view head) {
  std::string_view line = take_until(head, "\r\n");
  HttpRequest request;
  request.method = take_until(line, " ");
  request.target = take_until(line, " ");
  const bool known = line == "HTTP/1.1" || line == "HTTP/1.0";
  if (!known || !is_token(request.method) || request.target.empty() || request.target[0] != '/' ||
      !is_printable(request.target))
    return std::nullopt;
  while (!head.empty()) {
    std::string_view value = take_until(head, "\r\n");
    const std::string_view name = take_until(value, ":");
    if (!is_token(name) || !is_printable(value)) return std::nullopt;
    // A second Host or Origin could hide the one that is checked.
    if (!request.fields.emplace(lower_case(name), trimmed(value)).second &&
        (lower_case(name) == "host" || lower_case(name) == "origin"))
      return std::nullopt;
  }
  return request;
}

std::string http_response(std::string_view status, const Resource& resource, bool head_only) {
  std::string text = "HTTP/1.1 " + std::string(status) + "\r\nContent-Type: " + resource.type + "\r\n";
  if (!resource.encoding.empty()) text += "Content-Encoding: " + resource.encoding + "\r\n";
  text +=
      "Content-Security-Policy: default-src 'self' 'unsafe-inline' data: blob:; connect-src 'self' ws: wss:; "
      "frame-ancestors 'none'\r\n"
      "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n"
      "Connection: close\r\nContent-Length: " +
      std::to_string(resource.body.size()) + "\r\n\r\n";
  if (!head_only) text += resource.body;
  return text;
}

}  // namespace slalom::view
