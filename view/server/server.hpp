#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

/// Serves a page and a WebSocket to a handful of browsers from a thread of its own:
///
///     Server server({.port = 8400}, {{"/", page}});
///     while (driving) {
///       for (const Received& message : server.take()) obey(message);
///       server.publish(frame);   // never waits
///     }
///
/// Who publishes never waits for who looks: each client holds at most one frame that waits to be sent, and a
/// newer one takes its place. What must not be lost goes through `send` and `broadcast`, in order; a client
/// that lets too much of it pile up is disconnected.
namespace slalom::view {

struct ServerOptions {
  std::string host = "127.0.0.1";    ///< address to listen on
  std::uint16_t port = 0;            ///< 0: any that is free
  std::string token{};               ///< if not empty, asked for as `?token=` of page and WebSocket
  std::size_t max_message = 16384;   ///< bytes of a message from a client; a longer one ends the connection
  int max_clients = 32;              ///< further connections are turned away
  double messages_per_second = 120;  ///< of one client on average; messages beyond that are not delivered
  double burst = 240;                ///< messages that a client may send at once after silence
};

/// What is served under a path.
struct Resource {
  std::string type;      ///< Content-Type
  std::string encoding;  ///< Content-Encoding, or empty
  std::string body;
};

/// A message to clients; shared, so that one copy serves all.
struct Message {
  std::shared_ptr<const std::string> body;
  bool binary = false;
};

/// What has come from a client.
struct Received {
  enum class Kind { joined, left, message };
  Kind kind = Kind::message;
  std::uint64_t client = 0;
  std::string text;
};

/// What has happened since the start.
struct ServerCounters {
  std::uint64_t connections = 0;     ///< WebSockets opened
  std::uint64_t messages = 0;        ///< delivered to `take`
  std::uint64_t frames_sent = 0;     ///< to all clients
  std::uint64_t frames_dropped = 0;  ///< for clients that were not ready for them
  std::uint64_t refused_origin = 0;  ///< a page of another site, or a Host that is not ours
  std::uint64_t refused_token = 0;
  std::uint64_t refused_size = 0;
  std::uint64_t refused_rate = 0;
  std::uint64_t refused_other = 0;  ///< not HTTP, not WebSocket, not text, an unknown path, too many clients
};

class Server {
 public:
  /// Listens from now on. Throws std::invalid_argument on a host that is no address, std::runtime_error where
  /// the port cannot be had.
  Server(const ServerOptions& options, std::map<std::string, Resource> resources);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const noexcept;

  /// Hands a frame to every client that is ready for one by the time it can be sent; the latest wins.
  void publish(std::shared_ptr<const std::string> frame);
  /// Sends in order, to one client or to all.
  void send(std::uint64_t client, Message message);
  void broadcast(Message message);

  /// What has come since the last call; at most 1024 messages are kept, further ones count as refused by
  /// rate.
  std::vector<Received> take();
  /// Waits until something has come, `at_most` at longest.
  void wait(std::chrono::nanoseconds at_most);

  int clients() const noexcept;
  ServerCounters counters() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Whether an address is reached from this machine alone. Throws std::invalid_argument if it is no address.
bool is_loopback(const std::string& host);

}  // namespace slalom::view
