// Commands of a page to a session of the live view, one a line; and HTTP requests and WebSocket frames to its
// server. The first byte of the latter chooses whether the others are sent as they are, or behind the opening
// of a WebSocket.
#include <chrono>

#include "fuzz/target.hpp"
#include "view/car/car_subject.hpp"
#include "view/recording/drive_files.hpp"
#include "view/server/server.hpp"
#include "view/web_client.hpp"

namespace slalom::fuzz {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int max_commands = 24, max_ticks = 12;

view::SessionOptions session_options() {
  static const auto environment =
      evaluation::load_environment(SLALOM_COURSES "/wren", evaluation::Protocol::true_physics, {});
  view::SessionOptions options;
  options.scenario = {.course = "wren", .method = "mppi", .config = "default", .obstacles = 1};
  options.load = [](const view::ScenarioNames& names) {
    vehicle::Configuration configuration;
    for (const char* method : {"mppi", "svg_mppi", "cem"})
      vehicle::set_option(configuration, "samples", "16", method);
    return view::car_subject({environment,
                              {configuration, names.method},
                              {.obstacles = names.obstacles, .opponents = names.opponents}},
                             names.seed);
  };
  view::add_files(options, {});
  options.choices = {
      .courses = {"wren"}, .methods = {"mppi", "svg_mppi", "cem"}, .configurations = {"default"}};
  return options;
}

/// Waits until the server has got `messages`, or has closed the connection.
void await(view::Server& server, std::uint64_t messages, Clock::time_point until) {
  while (server.clients() > 0 && server.counters().messages < messages && Clock::now() < until)
    server.wait(std::chrono::milliseconds(1));
}

const Target commands_target(
    "commands", 2048,
    []() -> Seeds {
      return {R"({"do":"step","ticks":3,"id":1}
{"do":"seek","tick":1}
{"do":"add","kind":"disc","x":1,"y":0.5,"length":0.3}
{"do":"move","body":1,"x":1.5,"y":0,"yaw":0.1,"drag":1}
{"do":"undo"}
{"do":"redo"}
{"do":"remove","body":1}
)",
              R"({"do":"set","key":"mppi.temperature","value":"2"}
{"do":"fork","method":"svg_mppi","set":["svg_mppi.samples=16"]}
{"do":"ghost","method":"mppi"}
{"do":"step"}
{"do":"take_over"}
{"do":"reset_options"}
{"do":"method","method":"cem"}
)",
              R"({"do":"play"}
{"do":"rate","rate":0}
{"do":"real_time","on":true}
{"do":"pause"}
{"do":"place_car","x":0,"y":0,"yaw":1}
{"do":"nudge","left":0.1,"turn":-0.2}
{"do":"past","from":0,"to":2,"id":5}
{"do":"restart"}
{"do":"scenario","course":"wren","seed":"9","obstacles":1,"opponents":0}
{"do":"save","what":"recording"}
{"do":"step"}
)"};
    },
    [](std::string_view bytes) {
      const auto until = Clock::now() + std::chrono::seconds(2);
      view::Server server({.messages_per_second = 1e6, .burst = 1e6}, {});
      view::SessionOptions options = session_options();
      view::Session session(options.load(options.scenario), server, options);
      testing::WebClient client(server.port());
      client.get("/ws", true);
      while (server.clients() == 0 && Clock::now() < until) server.wait(std::chrono::milliseconds(1));
      std::uint64_t sent = 0;
      while (!bytes.empty() && sent < max_commands && Clock::now() < until) {
        const std::string_view line = bytes.substr(0, bytes.find('\n'));
        bytes.remove_prefix(std::min(bytes.size(), line.size() + 1));
        if (!client.send_message(line)) break;
        await(server, ++sent, until);
        for (int ticks = 0; ticks < max_ticks && (ticks == 0 || (session.is_busy() && Clock::now() < until));
             ++ticks)
          session.turn();
      }
      require(session.refused() <= sent, "a command is refused once");
      return sent > 0 && session.refused() == 0;
    },
    5 * max_commands);  // a tick with the most samples takes a second

using testing::WebClient;
constexpr std::size_t max_message = 1000;

/// A masked WebSocket frame.
std::string frame(unsigned first, std::string_view payload) {
  std::string bytes{static_cast<char>(first), static_cast<char>(0x80u | payload.size())};
  bytes += "mask";
  for (std::size_t i = 0; i < payload.size(); ++i) bytes += static_cast<char>(payload[i] ^ "mask"[i % 4]);
  return bytes;
}

/// Checks the messages that the server has received. Returns whether there was a client.
bool check_received(view::Server& server) {
  int clients = 0;
  for (const view::Received& each : server.take()) {
    if (each.kind == view::Received::Kind::joined) ++clients;
    if (each.kind != view::Received::Kind::message) continue;
    require(each.text.size() <= max_message, "messages are no longer than allowed");
  }
  require(clients <= 1, "a connection is one client");
  return clients == 1;
}

const Target server_target(
    "server", 4096,
    []() -> Seeds {
      const std::string get = "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n";
      const std::string upgrade =
          "GET /ws HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
          "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
      return {"h" + get + "Accept-Encoding: gzip\r\n\r\n",
              "h" + get + "Origin: http://127.0.0.1\r\nContent-Length: 3\r\n\r\nabc",
              "hHEAD /ws?ack=1 HTTP/1.1\r\nHost: localhost\r\n\r\n",
              "h" + upgrade + frame(0x81, "{}"),
              "w" + frame(0x81, R"({"do":"pause"})") + frame(0x82, std::string("\1\0\0\0", 4)) +
                  frame(0x89, "ping") + frame(0x88, "\x03\xe8"),
              "w" + frame(0x01, "in two") + frame(0x80, " parts") + frame(0x8a, "")};
    },
    [](std::string_view bytes) {
      static view::Server server({.max_message = max_message}, {{"/", {"text/html", "plain", "compressed"}}});
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
    });

}  // namespace
}  // namespace slalom::fuzz
