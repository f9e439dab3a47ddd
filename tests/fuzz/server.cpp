// HTTP requests and WebSocket frames to the server of the live view. The first byte chooses whether the
// others are sent as they are, or behind the opening of a WebSocket.
#include "view/server/server.hpp"
#include <initializer_list>

#include "fuzz/target.hpp"
#include "src/evaluation/json.hpp"
#include "view/web_client.hpp"

namespace slalom::fuzz {
namespace {

using testing::WebClient;
constexpr std::size_t max_message = 1000;

/// A masked WebSocket frame.
std::string frame(unsigned first, std::string_view payload) {
  std::string bytes{static_cast<char>(first), static_cast<char>(0x80u | payload.size())};
  bytes += "mask";
  for (std::size_t i = 0; i < payload.size(); ++i) bytes += static_cast<char>(payload[i] ^ "mask"[i % 4]);
  return bytes;
}

std::string joined(std::initializer_list<std::string> parts) {
  std::string all;
  for (const std::string& part : parts) all += part;
  return all;
}

std::vector<std::string> seeds() {
  const std::string get = "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n";
  const std::string upgrade =
      "GET /ws HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
      "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
  return {joined({"h", get, "Accept-Encoding: gzip\r\n\r\n"}),
          joined({"h", get, "Origin: http://127.0.0.1\r\nContent-Length: 3\r\n\r\nabc"}),
          "hHEAD /ws?ack=1 HTTP/1.1\r\nHost: localhost\r\n\r\n",
          joined({"h", upgrade, frame(0x81, "{}")}),
          joined({"w", frame(0x81, R"({"do":"pause"})"), frame(0x82, std::string("\1\0\0\0", 4)),
                  frame(0x89, "ping"), frame(0x88, "\x03\xe8")}),
          joined({"w", frame(0x01, "in two"), frame(0x80, " parts"), frame(0x8a, "")})};
}

/// Whether JSON can hold the text as it is.
bool is_utf8(const std::string& text) {
  return parse_json(json_text(text)).get<std::string>() == text;
}

/// Checks the messages that the server has received. Returns whether there was a client.
bool check_received(view::Server& server) {
  int clients = 0;
  for (const view::Received& each : server.take()) {
    if (each.kind == view::Received::Kind::joined) ++clients;
    if (each.kind != view::Received::Kind::message) continue;
    require(each.text.size() <= max_message, "messages are no longer than allowed");
    require(is_utf8(each.text), "messages are UTF-8");
  }
  require(clients <= 1, "a connection is one client");
  return clients == 1;
}

bool run(std::string_view bytes) {
  static view::Server server({.max_message = max_message}, {{"/", {"text/html", "compressed", true}}});
  if (bytes.empty()) return false;
  std::string answer;
  {
    WebClient client(server.port());
    if (bytes[0] == 'w') client.get("/ws", true);
    client.say(bytes.substr(1));
    client.end();
    answer = client.rest();
  }
  const bool has_joined = check_received(server);
  static int runs = 0;
  if (++runs % 16 == 0) {
    WebClient other(server.port());
    require(other.get("/").rfind("HTTP/1.1 200", 0) == 0, "another client gets the page");
  }
  return has_joined || answer.rfind("HTTP/1.1 200", 0) == 0;
}

const Target target("server", 4096, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
