#include "view/server/connections.hpp"

#include <algorithm>
#include <regex>

namespace slalom::view {
namespace {

constexpr std::uint32_t max_request = 8192;         // bytes of a request
constexpr std::size_t max_received = 1024;          // messages in the inbox
constexpr std::size_t max_queue = 256;              // messages that wait for a client
constexpr std::size_t max_queued_bytes = 64 << 20;  // a single message may be larger: a recording has 70 MB
constexpr std::uint32_t max_frames_under_way = 2;
constexpr std::chrono::seconds request_time{10};  // for a request, an answer or a handshake
constexpr std::chrono::seconds closing_time{2};   // for the other side to close
constexpr std::chrono::seconds silent_time{30};   // without a byte from a client; a ping is sent after half
constexpr int send_buffer = 1 << 18;  // bytes; small, so that a slow client does not see old frames

std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}

/// The path of a target, without its query.
std::string path_of(std::string_view target) {
  return std::string(target.substr(0, target.find('?')));
}

/// The value of a key in the query of a target; empty if there is none.
std::string_view query_value(std::string_view target, std::string_view key) {
  for (std::size_t at = target.find('?'); at != target.npos; at = target.find('&', at + 1)) {
    const std::string_view pair = target.substr(at + 1, target.substr(at + 1).find('&'));
    const std::size_t equals = pair.find('=');
    if (pair.substr(0, equals) == key && equals != pair.npos) return pair.substr(equals + 1);
  }
  return {};
}

/// Compares in a time that does not depend on how many characters are right.
bool same_secret(std::string_view a, std::string_view b) {
  int difference = a.size() != b.size();
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) difference |= a[i] ^ b[i];
  return difference == 0;
}

/// Whether a name in a request is one of this server. If the server can be reached from elsewhere, any name
/// may lead to it, and the token decides.
bool is_own_host(const ServerOptions& options, std::string_view host) {
  const bool is_v6 = host.starts_with('[');
  const std::string_view name = host.substr(0, is_v6 ? host.find(']') + 1 : host.find(':'));
  return !is_loopback(options.host) || name == "localhost" || name == "127.0.0.1" || name == "[::1]" ||
         name == options.host;
}

/// The status of the answer to a request, and the reason if it is refused.
struct Verdict {
  unsigned status = 200;  ///< status of HTTP; 101: the connection becomes a WebSocket
  std::string_view reason{};
};

/// Decides who may have what: host name, token and origin must be those of this server, and the path must be
/// one of its resources, or /ws for a WebSocket.
Verdict judge(const Connections& all, const http::request<http::empty_body>& request) {
  using http::field;
  // A second Host or Origin could hide the one that is checked.
  if (request.count(field::host) > 1 || request.count(field::origin) > 1)
    return {400, "Host and Origin must not be repeated\n"};
  const std::string_view target = view_of(request.target()), host = view_of(request[field::host]);
  if (!is_own_host(all.options, host)) return {403, "this host name is not served here\n"};
  if (!all.options.token.empty() && !same_secret(query_value(target, "token"), all.options.token))
    return {401, "open the printed address, which contains the token\n"};
  const bool is_upgrade = websocket::is_upgrade(request);
  if (is_upgrade && path_of(target) == "/ws") {
    // A browser always sends an Origin with a WebSocket; a client without is no page of another site.
    const std::string_view origin = view_of(request[field::origin]);
    if (!origin.empty() && origin != "http://" + std::string(host) &&
        origin != "https://" + std::string(host))
      return {403, "pages of another origin are not served\n"};
    if (all.client_count >= all.options.max_clients) return {503, "too many clients\n"};
    return {101};
  }
  if (request.method() != http::verb::get && request.method() != http::verb::head)
    return {405, "only GET and HEAD are supported\n"};
  if (is_upgrade || !all.resources.contains(path_of(target))) return {404, "not found\n"};
  return {};
}

}  // namespace

void Connections::deliver(Received received) {
  const std::lock_guard lock(mutex);
  if (received.kind == Received::Kind::message) {
    if (inbox.size() >= max_received) {
      ++refused;
      return;
    }
    ++messages;
  }
  inbox.push_back(std::move(received));
  arrived.notify_all();
}

HttpConnection::HttpConnection(Connections& all, tcp::socket&& socket)
    : all_(all), stream_(std::move(socket)), buffer_(2 * max_request) {
  ++all_.open;
  parser_.header_limit(max_request);
}

HttpConnection::~HttpConnection() {
  if (!is_handed_over_) --all_.open;
}

void HttpConnection::begin() {
  stream_.expires_after(request_time);
  http::async_read(stream_, buffer_, parser_, [self = shared_from_this()](error_code error, std::size_t) {
    if (!error)
      self->answer();
    else if (error != http::error::end_of_stream && error != beast::error::timeout)
      ++self->all_.refused;
  });
}

void HttpConnection::answer() {
  const auto& request = parser_.get();
  const std::string_view target = view_of(request.target());
  const Verdict verdict = judge(all_, request);
  if (verdict.status == 101) {
    const bool acknowledges = query_value(target, "acknowledge") == "1";
    stream_.expires_never();  // the WebSocket has its own timeouts
    is_handed_over_ = true;
    std::make_shared<WebSocketClient>(all_, std::move(stream_), acknowledges)->open(parser_.release());
    return;
  }
  response_.result(verdict.status);
  std::string_view body = verdict.reason;
  if (verdict.status == 200) {
    const Resource& resource = all_.resources.at(path_of(target));
    response_.set(http::field::content_type, resource.type);
    // A client that asks for gzip, and not with the weight 0 (RFC 9110, 12.5.3).
    static const std::regex gzip(R"((^|[ \t,])gzip[ \t]*(,|$|;[ \t]*q=(1|0?[.]0*[1-9])))", std::regex::icase);
    const std::string_view asks = view_of(request[http::field::accept_encoding]);
    const bool packed = !resource.gzip.empty() && std::regex_search(asks.begin(), asks.end(), gzip);
    if (packed) response_.set(http::field::content_encoding, "gzip");
    // The page declares its policy in its head, but browsers take this part of it from the header alone.
    response_.set("Content-Security-Policy", "frame-ancestors " + all_.options.framed_by);
    body = resource.later ? resource.later() : packed ? resource.gzip : resource.body;
  } else {
    ++all_.refused;
    response_.set(http::field::content_type, "text/plain; charset=utf-8");
  }
  response_.body() = {body.data(), body.size()};
  response_.set(http::field::cache_control, "no-store");
  response_.set("X-Content-Type-Options", "nosniff");
  response_.set("Referrer-Policy", "no-referrer");
  response_.keep_alive(false);
  response_.prepare_payload();
  if (request.method() == http::verb::head) response_.body() = {};
  stream_.expires_after(request_time);
  http::async_write(stream_, response_, [self = shared_from_this()](error_code error, std::size_t) {
    if (error) return;
    self->stream_.socket().shutdown(tcp::socket::shutdown_send, error);
    self->stream_.expires_after(closing_time);
    self->read_to_end();
  });
}

/// Reads until the other side closes: closing with unread bytes would discard the response.
void HttpConnection::read_to_end() {
  stream_.async_read_some(asio::buffer(rest_), [self = shared_from_this()](error_code error, std::size_t) {
    if (!error) self->read_to_end();
  });
}

WebSocketClient::WebSocketClient(Connections& all, beast::tcp_stream&& stream, bool acknowledges)
    : all_(all),
      socket_(std::move(stream)),
      id_(all.next_client++),
      acknowledges_(acknowledges),
      allowance_(all.options.burst) {}

WebSocketClient::~WebSocketClient() {
  --all_.open;
}

void WebSocketClient::open(http::request<http::empty_body> request) {
  request_ = std::move(request);
  socket_.set_option(websocket::stream_base::timeout{request_time, silent_time, true});
  socket_.auto_fragment(false);  // each message is one WebSocket frame
  socket_.read_message_max(all_.options.max_message);
  socket_.async_accept(request_, [self = shared_from_this()](error_code error) {
    if (error) {
      ++self->all_.refused;
      return;
    }
    auto& socket = beast::get_lowest_layer(self->socket_).socket();
    socket.set_option(tcp::no_delay(true), error);
    socket.set_option(asio::socket_base::send_buffer_size(send_buffer), error);
    self->is_open_ = true;
    self->all_.clients.emplace(self->id_, self);
    ++self->all_.client_count;
    self->all_.deliver({Received::Kind::joined, self->id_, {}});
    self->read();
  });
}

void WebSocketClient::send(const Message& message) {
  if (!is_open_) return;
  if (queue_.size() < max_queue && queued_bytes_ < max_queued_bytes) {
    queued_bytes_ += message.body->size();
    queue_.push_back(message);
    return write_next();
  }
  error_code ignored;
  beast::get_lowest_layer(socket_).socket().close(ignored);
  leave();
}

void WebSocketClient::offer(const std::shared_ptr<const std::string>& frame) {
  if (!is_open_) return;
  if (std::exchange(frame_, frame)) ++all_.frames_dropped;
  write_next();
}

void WebSocketClient::read() {
  socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
    if (error) {
      if (error == websocket::error::message_too_big || error == websocket::error::buffer_overflow ||
          error == websocket::condition::protocol_violation)
        ++self->all_.refused;
      return self->leave();
    }
    self->take_message();
    self->buffer_.clear();
    self->read();
  });
}

void WebSocketClient::take_message() {
  // Acknowledgements do not count as messages: there are never more of them than frames.
  if (socket_.got_binary() && acknowledge())
    write_next();
  else if (is_within_rate() && socket_.got_text())
    all_.deliver({Received::Kind::message, id_, beast::buffers_to_string(buffer_.data())});
  else
    ++all_.refused;
}

/// Takes an acknowledgement: the number of frames shown so far, little-endian. False if it is none.
bool WebSocketClient::acknowledge() {
  const auto bytes = buffer_.cdata();
  if (!acknowledges_ || bytes.size() != 4) return false;
  const auto* digits = static_cast<const unsigned char*>(bytes.data());
  std::uint32_t frames = 0;
  for (int i = 3; i >= 0; --i) frames = frames << 8 | digits[i];
  if (frames > frames_sent_ || frames <= frames_acknowledged_) return false;
  frames_acknowledged_ = frames;
  return true;
}

/// Counts a message. False if the client sends more than it may.
bool WebSocketClient::is_within_rate() {
  const auto now = std::chrono::steady_clock::now();
  const double passed = std::chrono::duration<double>(now - std::exchange(last_message_, now)).count();
  allowance_ = std::min(all_.options.burst, allowance_ + passed * all_.options.messages_per_second);
  if (allowance_ < 1) return false;
  allowance_ -= 1;
  return true;
}

void WebSocketClient::write_next() {
  if (is_writing_ || !is_open_) return;
  Message next;
  if (!queue_.empty()) {
    next = std::move(queue_.front());
    queue_.pop_front();
    queued_bytes_ -= next.body->size();
  } else if (frame_ && (!acknowledges_ || frames_sent_ - frames_acknowledged_ < max_frames_under_way)) {
    next = {std::exchange(frame_, nullptr), true};
    ++frames_sent_;  // it may be acknowledged before the handler below is called
  } else {
    return;
  }
  is_writing_ = true;
  socket_.binary(next.binary);
  const auto bytes = asio::buffer(*next.body);
  // The handler keeps the message until it is sent.
  socket_.async_write(bytes, [self = shared_from_this(), next](error_code error, std::size_t) {
    self->is_writing_ = false;
    if (error) return self->leave();
    self->write_next();
  });
}

void WebSocketClient::leave() {
  if (!is_open_) return;
  is_open_ = false;
  queue_.clear();
  frame_ = nullptr;
  all_.clients.erase(id_);
  --all_.client_count;
  all_.deliver({Received::Kind::left, id_, {}});
}

}  // namespace slalom::view
