#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <utility>  // before asio, which needs it in C++20 and does not include it

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "view/server/server.hpp"

/// The connections of a server. Included by server.cpp and connections.cpp only: Boost takes long to compile.
namespace slalom::view {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using beast::error_code;

class WebSocketClient;

/// Shared by all connections. Options and resources do not change; inbox and counters may be used from any
/// thread, the rest from the server's thread only.
struct Connections {
  const ServerOptions options;
  const std::map<std::string, Resource> resources;
  std::map<std::uint64_t, std::shared_ptr<WebSocketClient>> clients{};
  std::uint64_t next_client = 1;
  int open = 0;  ///< connections of all kinds

  std::atomic<int> client_count{0};
  std::atomic<std::uint64_t> messages{0}, frames_dropped{0}, refused{0};
  std::mutex mutex{};
  std::condition_variable arrived{};
  std::vector<Received> inbox{};  ///< guarded by `mutex`

  /// Puts something into the inbox; of messages, at most 1024 are kept.
  void deliver(Received received);
};

/// One HTTP request, which is answered or becomes a client. Exists as long as an operation of it is pending.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(Connections& all, tcp::socket&& socket);
  ~HttpConnection();
  void begin();

 private:
  void answer();
  void read_to_end();

  Connections& all_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  http::response<http::span_body<const char>> response_;  // views of the resources
  std::array<char, 1024> rest_{};
  bool is_handed_over_ = false;
};

/// One WebSocket. Exists as long as an operation of it is pending.
class WebSocketClient : public std::enable_shared_from_this<WebSocketClient> {
 public:
  /// `acknowledges`: the client tells how many frames it has shown, and has at most two under way.
  WebSocketClient(Connections& all, beast::tcp_stream&& stream, bool acknowledges);
  ~WebSocketClient();

  void open(http::request<http::empty_body> request);
  /// Sends a message after those that wait. Disconnects the client if too many do.
  void send(const Message& message);
  /// Sends a frame once no message waits; a newer frame replaces it until then.
  void offer(const std::shared_ptr<const std::string>& frame);

 private:
  void read();
  void take_message();
  bool acknowledge();
  bool is_within_rate();
  void write_next();
  void leave();

  Connections& all_;
  websocket::stream<beast::tcp_stream, false> socket_;  // without compression
  std::uint64_t id_;
  http::request<http::empty_body> request_;
  beast::flat_buffer buffer_;
  std::deque<Message> queue_;
  std::size_t queued_bytes_ = 0;
  std::shared_ptr<const std::string> frame_;  // pending
  const bool acknowledges_;
  std::uint32_t frames_sent_ = 0, frames_acknowledged_ = 0;
  double allowance_;  // messages that the client may send now
  std::chrono::steady_clock::time_point last_message_ = std::chrono::steady_clock::now();
  bool is_writing_ = false;
  bool is_open_ = false;
};

}  // namespace slalom::view
