#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "view/server/http.hpp"
#include "view/server/server.hpp"
#include "view/server/socket.hpp"
#include "view/server/websocket.hpp"

namespace slalom::view {

using Clock = std::chrono::steady_clock;

struct AtomicCounters {
  std::atomic<std::uint64_t> connections{0}, messages{0}, frames_sent{0}, frames_dropped{0},
      refused_origin{0}, refused_token{0}, refused_size{0}, refused_rate{0}, refused_other{0};
};

/// What the connections of a server share.
struct ServerState {
  ServerOptions options;
  std::map<std::string, Resource> resources;
  bool loopback = true;  ///< can be reached from this machine alone
  AtomicCounters counters;
  std::atomic<int> clients{0};
  std::uint64_t next_client = 1;

  std::mutex received_mutex;
  std::condition_variable received_condition;
  std::vector<Received> received;

  /// Keeps it for `Server::take`, unless too much waits there already.
  void deliver(Received message);
};

/// One connection: an HTTP request that is answered or becomes a WebSocket. Used by the server's thread
/// alone.
class Connection {
 public:
  Connection(ServerState& state, Descriptor socket);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  int descriptor() const noexcept { return socket_.number(); }
  /// The number of the client; 0 while it is not a WebSocket.
  std::uint64_t client() const noexcept { return client_; }
  /// Once true, the connection is to be destroyed.
  bool is_over() const noexcept { return stage_ == Stage::over; }
  /// Whether there is something to be sent.
  bool has_output() const noexcept { return sent_ < output_size(); }

  void read();
  void write();
  /// Ends what takes too long; sends pings to a silent client.
  void check_time(Clock::time_point now);
  /// Ends the connection at once.
  void drop();

  /// Sends a message after those that wait; ends the connection if too much waits.
  void queue(const Message& message);
  /// Sends a frame as soon as nothing else waits; a newer frame takes its place.
  void offer(const std::shared_ptr<const std::string>& frame);

 private:
  enum class Stage { request, client, closing, over };

  std::size_t output_size() const noexcept { return head_.size() + (body_ ? body_->size() : 0); }
  void read_request();
  void answer(const HttpRequest& request);
  void become_client(const HttpRequest& request);
  void respond(std::string_view status, const Resource& resource, bool head_only);
  void refuse(std::string_view status, const char* reason);
  void read_messages();
  bool handle(websocket::Decoder::Event event);
  void got_message(bool text);
  bool within_rate();
  void close_with(websocket::CloseCode code);
  void leave();
  void start_next_output();

  ServerState& state_;
  Descriptor socket_;
  Stage stage_ = Stage::request;
  std::uint64_t client_ = 0;
  Clock::time_point last_received_, deadline_;
  bool pinged_ = false;
  std::string request_;  ///< received so far
  websocket::Decoder decoder_;

  std::string head_;                         ///< under way: the head of a frame, or all of a response
  std::shared_ptr<const std::string> body_;  ///< and the message after it
  std::size_t sent_ = 0;                     ///< bytes of both
  bool sending_frame_ = false;
  std::string control_;  ///< frames of the protocol itself, which go first
  std::deque<Message> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::shared_ptr<const std::string> frame_;

  double allowance_;  ///< messages that may be received now
  Clock::time_point last_message_;
};

}  // namespace slalom::view
