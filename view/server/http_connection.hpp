#pragma once

#include "view/server/web_socket_client.hpp"

#include <array>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/write.hpp>

#include "view/server/access.hpp"

/// Included by network.cpp only: Boost takes long to compile.
namespace slalom::view {

inline constexpr std::uint32_t max_request = 8192;      // bytes of a request
inline constexpr std::chrono::seconds closing_time{2};  // for the other side to close

inline std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}

/// One HTTP request, which is answered or becomes a client. Exists as long as an operation of it is pending.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(ServerState& state, tcp::socket&& socket) : state_(state), stream_(std::move(socket)) {
    ++state_.open_connections;
    parser_.header_limit(max_request);
  }
  ~HttpConnection() {
    if (!is_handed_over_) --state_.open_connections;
  }

  void begin() {
    stream_.expires_after(request_time);
    http::async_read(stream_, buffer_, parser_, [self = shared_from_this()](error_code error, std::size_t) {
      self->is_waiting_ = false;
      if (!error)
        self->answer();
      else if (error != http::error::end_of_stream && error != beast::error::timeout)
        ++self->state_.counters.refused_other;
    });
  }

  /// Whether its request has not arrived yet.
  bool is_waiting() const { return is_waiting_; }
  /// Closes the connection.
  void drop() {
    error_code ignored;
    stream_.socket().close(ignored);
  }

 private:
  void answer() {
    const auto& request = parser_.get();
    const Answer answer = answer_to(
        state_,
        {.method = view_of(request.method_string()),
         .target = view_of(request.target()),
         .host = view_of(request[http::field::host]),
         .origin = view_of(request[http::field::origin]),
         .accept_encoding = view_of(request[http::field::accept_encoding]),
         .is_upgrade = websocket::is_upgrade(request),
         .is_ambiguous = request.count(http::field::host) > 1 || request.count(http::field::origin) > 1});
    if (answer.status == 101) return become_client(answer.acknowledges);
    response_.result(answer.status);
    std::string_view body = answer.reason;
    if (answer.resource)
      body = add_resource(*answer.resource, answer.encoded);
    else
      response_.set(http::field::content_type, "text/plain; charset=utf-8");
    response_.body() = {body.data(), body.size()};
    respond();
  }

  void become_client(bool acknowledges) {
    stream_.expires_never();  // the WebSocket has its own timeouts
    is_handed_over_ = true;
    std::make_shared<WebSocketClient>(state_, std::move(stream_), acknowledges)->open(parser_.release());
  }

  /// Sets the header fields of a resource. The body.
  std::string_view add_resource(const Resource& resource, bool encoded) {
    response_.set(http::field::content_type, resource.type);
    if (encoded) response_.set(http::field::content_encoding, resource.encoding);
    if (!resource.encoding.empty()) response_.set(http::field::vary, "Accept-Encoding");
    // Browsers ignore frame-ancestors in the head of a page, so the header alone has it.
    response_.set("Content-Security-Policy", resource.policy + "; frame-ancestors 'none'");
    return encoded || resource.encoding.empty() ? resource.body : resource.plain;
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
  beast::flat_buffer buffer_{2 * max_request};
  http::request_parser<http::empty_body> parser_;
  http::response<http::span_body<const char>> response_;  // views of the resources
  std::array<char, 1024> rest_{};
  bool is_waiting_ = true;
  bool is_handed_over_ = false;
};

}  // namespace slalom::view
