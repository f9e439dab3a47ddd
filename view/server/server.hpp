#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

/// Serves a page and a WebSocket to a few browsers from its own thread:
///
///     Server server({.port = 8400}, {{"/", page}});
///     while (driving) {
///       for (const Received& message : server.take()) execute(message);
///       server.publish(frame);   // never waits
///     }
///
/// Publishing never waits for clients: each client has at most one pending frame, which a newer frame
/// replaces. A client that acknowledges frames (see FrameFlow) has at most two frames under way. Messages
/// overtake pending frames. Messages that must not be lost are sent in order with `send` and `broadcast`; a
/// client with too many pending messages is disconnected.
namespace slalom::view {

struct ServerOptions {
  std::string host = "127.0.0.1";   ///< address to listen on
  std::uint16_t port = 0;           ///< 0: any that is free
  std::string token{};              ///< if not empty, asked for as `?token=` of page and WebSocket
  std::size_t max_message = 16384;  ///< bytes of a message from a client; a longer one ends the connection
  int max_clients = 32;             ///< further connections are turned away
  double messages_per_second =
      120;             ///< messages of one client on average; messages beyond that are not delivered
  double burst = 240;  ///< messages that a client may send at once after silence
};

/// A resource that is served under a path.
struct Resource {
  std::string type;        ///< Content-Type
  std::string encoding{};  ///< Content-Encoding, or empty
  std::string body{};      ///< in that encoding
  std::string plain{};     ///< the body without the encoding, for clients that do not accept it
  /// Content-Security-Policy, to which the server adds that no other page may show this one in a frame.
  std::string policy = "default-src 'none'";
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

/// Counters since the start.
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
  /// Starts to listen. Throws std::invalid_argument if the host is not an IP address, std::runtime_error if
  /// the port cannot be bound.
  Server(const ServerOptions& options, std::map<std::string, Resource> resources);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const noexcept;

  /// Sends a frame to every client that is ready for it; a newer frame replaces a pending one.
  void publish(std::shared_ptr<const std::string> frame);
  /// Sends a frame to one client, likewise.
  void publish(std::uint64_t client, std::shared_ptr<const std::string> frame);
  /// Sends in order, to one client or to all.
  void send(std::uint64_t client, Message message);
  void broadcast(Message message);

  /// The messages since the last call; at most 1024 messages are kept, further ones count as refused by
  /// rate.
  std::vector<Received> take();
  /// Waits for a message, for `at_most` at most.
  void wait(std::chrono::nanoseconds at_most);

  int clients() const noexcept;
  ServerCounters counters() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Whether an address can be reached from this machine only. Throws std::invalid_argument if it is not an IP
/// address.
bool is_loopback(const std::string& host);

}  // namespace slalom::view
