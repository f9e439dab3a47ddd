#include "view/server/network.hpp"

#include <utility>  // before asio, which needs it in C++20 and does not include it

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
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
#include <chrono>
#include <stdexcept>
#include <thread>

#include "view/server/access.hpp"
#include "view/server/frame_flow.hpp"
#include "view/server/outgoing_queue.hpp"
#include "view/server/rate_limit.hpp"

namespace slalom::view {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using beast::error_code;
using namespace std::chrono_literals;

constexpr std::uint32_t most_request = 8192;  // bytes of a request
constexpr auto request_time = 10s;            // for a request, an answer or a handshake
constexpr auto closing_time = 2s;             // for the other side to close
constexpr auto silent_time = 30s;             // without a byte from a client; a ping is sent after half of it
constexpr int send_buffer = 1 << 18;          // bytes; small, so that a slow client does not see old frames

std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}

/// One WebSocket. Exists as long as an operation of it is pending.
class WebSocketClient final : public Client, public std::enable_shared_from_this<WebSocketClient> {
 public:
  WebSocketClient(ServerState& state, beast::tcp_stream&& stream, bool acknowledges)
      : state_(state),
        socket_(std::move(stream)),
        id_(state.next_client++),
        rate_(state.options.messages_per_second, state.options.burst),
        flow_(acknowledges) {}

  ~WebSocketClient() override { --state_.open_connections; }

  void open(http::request<http::empty_body> request) {
    request_ = std::move(request);
    socket_.set_option(websocket::stream_base::timeout{request_time, silent_time, true});
    socket_.auto_fragment(false);  // each message is one WebSocket frame
    socket_.read_message_max(state_.options.max_message);
    socket_.async_accept(request_, [self = shared_from_this()](error_code error) {
      if (error)
        ++self->state_.counters.refused_other;
      else
        self->opened();
    });
  }

  void send(const Message& message) override {
    if (!is_open_) return;
    if (queue_.push(message)) return write_next();
    error_code ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
    leave();
  }

  void offer(const std::shared_ptr<const std::string>& frame) override {
    if (!is_open_) return;
    if (queue_.set_frame(frame)) ++state_.counters.frames_dropped;
    write_next();
  }

 private:
  void opened() {
    error_code ignored;
    auto& socket = beast::get_lowest_layer(socket_).socket();
    socket.set_option(tcp::no_delay(true), ignored);
    socket.set_option(asio::socket_base::send_buffer_size(send_buffer), ignored);
    is_open_ = true;
    state_.clients.add(id_, shared_from_this());
    ++state_.counters.connections;
    state_.inbox.deliver({Received::Kind::joined, id_, {}});
    read();
  }

  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->failed(error);
      self->got_message();
      self->buffer_.clear();
      self->read();
    });
  }

  void failed(error_code error) {
    if (error == websocket::error::message_too_big || error == websocket::error::buffer_overflow)
      ++state_.counters.refused_size;
    else if (error == websocket::condition::protocol_violation)
      ++state_.counters.refused_other;
    leave();
  }

  void got_message() {
    // Acknowledgements do not count as messages: there are never more of them than frames.
    if (socket_.got_binary() && acknowledge()) return write_next();
    if (!rate_.allow())
      ++state_.counters.refused_rate;
    else if (!socket_.got_text())
      ++state_.counters.refused_other;
    else
      state_.inbox.deliver({Received::Kind::message, id_, beast::buffers_to_string(buffer_.data())});
  }

  /// True if the message is a valid acknowledgement: the number of frames shown so far, little-endian.
  bool acknowledge() {
    const auto bytes = buffer_.cdata();
    if (bytes.size() != 4) return false;
    const auto* digits = static_cast<const unsigned char*>(bytes.data());
    std::uint32_t frames = 0;
    for (int i = 3; i >= 0; --i) frames = frames << 8 | digits[i];
    return flow_.acknowledge(frames);
  }

  void write_next() {
    if (is_writing_ || !is_open_) return;
    auto item = queue_.next(flow_.may_send());
    if (!item) return;
    is_writing_ = true;
    if (item->is_frame) flow_.count_sent();  // it may be acknowledged before the handler below is called
    socket_.binary(item->message.binary);
    const auto bytes = asio::buffer(*item->message.body);
    // The handler keeps the message until it is sent.
    socket_.async_write(bytes,
                        [self = shared_from_this(), item = std::move(*item)](error_code error, std::size_t) {
                          self->is_writing_ = false;
                          if (error) return self->leave();
                          if (item.is_frame) ++self->state_.counters.frames_sent;
                          self->write_next();
                        });
  }

  void leave() {
    if (!is_open_) return;
    is_open_ = false;
    queue_.clear();
    state_.clients.remove(id_);
    state_.inbox.deliver({Received::Kind::left, id_, {}});
  }

  ServerState& state_;
  websocket::stream<beast::tcp_stream, false> socket_;  // without compression
  std::uint64_t id_;
  RateLimit rate_;
  http::request<http::empty_body> request_;
  beast::flat_buffer buffer_;
  OutgoingQueue queue_;
  FrameFlow flow_;
  bool is_writing_ = false;
  bool is_open_ = false;
};

/// One HTTP request, which is answered or becomes a client. Exists as long as an operation of it is pending.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(ServerState& state, tcp::socket&& socket) : state_(state), stream_(std::move(socket)) {
    ++state_.open_connections;
    parser_.header_limit(most_request);
  }
  ~HttpConnection() {
    if (!is_handed_over_) --state_.open_connections;
  }

  void begin() {
    stream_.expires_after(request_time);
    http::async_read(stream_, buffer_, parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (!error)
        self->answer();
      else if (error != http::error::end_of_stream && error != beast::error::timeout)
        ++self->state_.counters.refused_other;
    });
  }

 private:
  void answer() {
    const auto& request = parser_.get();
    const Answer answer = answer_to(state_, {.method = view_of(request.method_string()),
                                             .target = view_of(request.target()),
                                             .host = view_of(request[http::field::host]),
                                             .origin = view_of(request[http::field::origin]),
                                             .is_upgrade = websocket::is_upgrade(request),
                                             .is_ambiguous = request.count(http::field::host) > 1 ||
                                                             request.count(http::field::origin) > 1});
    if (answer.status == 101) return become_client(answer.acknowledges);
    response_.result(answer.status);
    if (answer.resource)
      add_resource(*answer.resource);
    else
      response_.set(http::field::content_type, "text/plain; charset=utf-8");
    const std::string_view body = answer.resource ? std::string_view(answer.resource->body) : answer.reason;
    response_.body() = {body.data(), body.size()};
    respond();
  }

  void become_client(bool acknowledges) {
    stream_.expires_never();  // the WebSocket has its own timeouts
    is_handed_over_ = true;
    std::make_shared<WebSocketClient>(state_, std::move(stream_), acknowledges)->open(parser_.release());
  }

  void add_resource(const Resource& resource) {
    response_.set(http::field::content_type, resource.type);
    if (!resource.encoding.empty()) response_.set(http::field::content_encoding, resource.encoding);
    response_.set("Content-Security-Policy",
                  "default-src 'self' 'unsafe-inline' data: blob:; connect-src 'self' ws: wss:; "
                  "frame-ancestors 'none'");
  }

  void respond() {
    response_.set(http::field::cache_control, "no-store");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.keep_alive(false);
    response_.prepare_payload();
    if (parser_.get().method() == http::verb::head) response_.body() = {};
    stream_.expires_after(request_time);
    http::async_write(stream_, response_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, error);
      self->stream_.expires_after(closing_time);
      self->read_to_end();
    });
  }

  /// Reads until the other side closes: closing with unread bytes would discard the response.
  void read_to_end() {
    stream_.async_read_some(asio::buffer(rest_), [self = shared_from_this()](error_code error, std::size_t) {
      if (!error) self->read_to_end();
    });
  }

  ServerState& state_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{2 * most_request};
  http::request_parser<http::empty_body> parser_;
  http::response<http::span_body<const char>> response_;  // views of the resources
  std::array<char, 1024> rest_{};
  bool is_handed_over_ = false;
};

asio::ip::address parse_address(const std::string& host) {
  error_code error;
  const auto address = asio::ip::make_address(host == "localhost" ? "127.0.0.1" : host, error);
  if (error) throw std::invalid_argument("host '" + host + "' must be an IP address");
  return address;
}

}  // namespace

bool is_loopback(const std::string& host) {
  return parse_address(host).is_loopback();
}

struct Network::Implementation {
  ServerState& state;
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  std::uint16_t port = 0;
  std::thread thread;

  explicit Implementation(ServerState& shared) : state(shared) {
    listen();
    accept();
    thread = std::thread([this] { run(); });
  }

  ~Implementation() {
    context.stop();
    thread.join();
    state.clients.clear();  // before the context, which their sockets use
  }

  void listen() {
    const ServerOptions& options = state.options;
    const tcp::endpoint endpoint(parse_address(options.host), options.port);
    try {
      acceptor.open(endpoint.protocol());
      acceptor.set_option(asio::socket_base::reuse_address(true));
      acceptor.bind(endpoint);
      acceptor.listen();
      port = acceptor.local_endpoint().port();
    } catch (const std::exception& error) {
      throw std::runtime_error("cannot listen on " + options.host + ":" + std::to_string(options.port) +
                               ": " + error.what());
    }
  }

  void accept() {
    acceptor.async_accept([this](error_code error, tcp::socket socket) {
      if (!error && state.open_connections < 4 * state.options.max_clients)
        std::make_shared<HttpConnection>(state, std::move(socket))->begin();
      else if (!error)
        ++state.counters.refused_other;
      accept();
    });
  }

  void run() {
    while (!context.stopped()) {
      try {
        context.run();
      } catch (const std::exception&) {
        ++state.counters.refused_other;  // a failure of one client must not end the others
      }
    }
  }
};

Network::Network(ServerState& state) : implementation_(std::make_unique<Implementation>(state)) {}
Network::~Network() = default;

std::uint16_t Network::port() const noexcept {
  return implementation_->port;
}

void Network::post(std::function<void()> call) {
  asio::post(implementation_->context, std::move(call));
}

}  // namespace slalom::view
