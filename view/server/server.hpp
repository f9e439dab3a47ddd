#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

/// Serves a page and a WebSocket to a few browsers from its own thread:
///
///     Server server({.port = 8400}, {{"/", page}});
///     while (driving) {
///       for (const Received& message : server.take()) execute(message);
///       server.publish(0, frame);   // never waits
///     }
///
/// Each client has at most one pending frame, which a newer one replaces; a client that acknowledges frames
/// has at most two under way. Messages are sent in order, before a pending frame; a client with too many
/// pending messages is disconnected.
namespace slalom::view {

struct ServerOptions {
  std::string host = "127.0.0.1";    ///< IP address to listen on
  std::uint16_t port = 0;            ///< port to listen on; 0: any that is free
  int ports = 1;                     ///< ports from `port` on, the first of which that is free is taken
  std::string token{};               ///< if not empty, page and WebSocket need `?token=`
  std::string framed_by = "'none'";  ///< pages that may show this one inside, as in `frame-ancestors`
  std::size_t max_message = 16384;   ///< bytes of a message from a client; a longer one ends the connection
  int max_clients = 32;              ///< further WebSockets are refused
  double messages_per_second = 120;  ///< mean rate of one client; messages beyond it are not delivered
  double burst = 240;                ///< messages that a client may send at once after silence
};

/// The pages of notebooks, for `framed_by`.
inline constexpr const char* notebooks = "http://localhost:* http://127.0.0.1:* vscode-webview: vscode-file:";

/// A resource that is served under a path.
struct Resource {
  std::string type;    ///< Content-Type
  std::string body;    ///< content
  std::string gzip{};  ///< the body compressed with gzip, for clients that ask for it; empty: none
  std::function<const std::string&()> later{};  ///< returns the body, where the first request is to make it
};

/// A message to clients; shared, so that one copy serves all.
struct Message {
  std::shared_ptr<const std::string> body;
  bool binary = false;
};

/// A message or event from a client.
struct Received {
  enum class Kind { joined, left, message };
  Kind kind = Kind::message;
  std::uint64_t client = 0;
  std::string text;
};

/// Numbers of messages since the start.
struct ServerCounters {
  std::uint64_t messages = 0;        ///< delivered to `take`
  std::uint64_t frames_dropped = 0;  ///< replaced by newer ones before they were sent
  std::uint64_t refused = 0;         ///< requests, connections and messages that break a rule
};

class Server {
 public:
  /// Starts to listen. Throws std::invalid_argument if the host is not an IP address, std::runtime_error if
  /// the port cannot be bound or no thread be started.
  Server(const ServerOptions& options, std::map<std::string, Resource> resources);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const noexcept;

  /// Sends a frame to one client, or to all with 0, as soon as it is ready for a frame.
  void publish(std::uint64_t client, std::shared_ptr<const std::string> frame);
  /// Sends a message to one client, or to all with 0.
  void send(std::uint64_t client, Message message);

  /// Returns what has come since the last call. At most 1024 messages are kept.
  std::vector<Received> take();
  /// Waits until something comes, for `at_most` at most.
  void wait(std::chrono::nanoseconds at_most);

  int clients() const noexcept;
  ServerCounters counters() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The address of a page.
std::string address_of(const Server& server, const ServerOptions& options, const std::string& path = "/");

/// Whether only this machine reaches an address. Throws std::invalid_argument if it is no IP address.
bool is_loopback(const std::string& host);

}  // namespace slalom::view
