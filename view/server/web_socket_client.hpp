#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>  // before asio, which needs it in C++20 and does not include it

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>

#include "view/server/frame_flow.hpp"
#include "view/server/outgoing_queue.hpp"
#include "view/server/rate_limit.hpp"
#include "view/server/server_state.hpp"

/// Included by network.cpp only: Boost takes long to compile.
namespace slalom::view {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using beast::error_code;

inline constexpr std::chrono::seconds request_time{10};  // for a request, an answer or a handshake
inline constexpr std::chrono::seconds silent_time{
    30};                                     // without a byte from a client; a ping is sent after half of it
inline constexpr int send_buffer = 1 << 18;  // bytes; small, so that a slow client does not see old frames

/// Whether a text whose characters are otherwise valid UTF-8 ends within one.
inline bool ends_within_character(std::string_view text) {
  for (std::size_t bytes = 1; bytes <= std::min<std::size_t>(3, text.size()); ++bytes) {
    const auto last = static_cast<unsigned char>(text[text.size() - bytes]);
    if ((last & 0xC0u) != 0x80u)
      return bytes < (last >= 0xF0u ? 4u : last >= 0xE0u ? 3u : last >= 0xC0u ? 2u : 1u);
  }
  return false;
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
      if (!self->got_message()) return self->refuse_text();
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

  /// False if the message is a text that is not UTF-8.
  bool got_message() {
    // Acknowledgements do not count as messages: there are never more of them than frames.
    if (socket_.got_binary() && acknowledge()) {
      write_next();
      return true;
    }
    std::string message = beast::buffers_to_string(buffer_.data());
    // Beast does not check the end of a message whose last frame is empty.
    if (socket_.got_text() && ends_within_character(message)) return false;
    if (!rate_.allow())
      ++state_.counters.refused_rate;
    else if (!socket_.got_text())
      ++state_.counters.refused_other;
    else
      state_.inbox.deliver({Received::Kind::message, id_, std::move(message)});
    return true;
  }

  void refuse_text() {
    ++state_.counters.refused_other;
    leave();
    socket_.async_close(websocket::close_code::bad_payload, [self = shared_from_this()](error_code) {});
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

}  // namespace slalom::view
