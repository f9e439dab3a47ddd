#include "view/server/connection.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

namespace slalom::view {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t most_waiting = 256;             // messages queued for a client
constexpr std::size_t most_waiting_bytes = 64 << 20;  // bytes of them
constexpr std::size_t most_received = 1024;           // messages kept for `Server::take`
constexpr std::size_t most_request = 8192;            // bytes of a request
constexpr std::size_t most_control = 4096;            // bytes of unsent answers to pings
constexpr auto request_time = 10s;                    // for a request to arrive
constexpr auto closing_time = 2s;                     // for the other side to close
constexpr auto ping_time = 15s, silent_time = 30s;    // without a byte from a client

/// Compares in a time that does not depend on how many characters are right.
bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  return difference == 0;
}

/// A host without its port.
std::string_view host_name(std::string_view host) {
  if (!host.empty() && host.front() == '[') return host.substr(0, host.find(']') + 1);
  return host.substr(0, host.find(':'));
}

/// Where the server can be reached from elsewhere, any name may lead to it, and the token decides.
bool is_own_host(const ServerState& state, std::string_view host) {
  const std::string_view name = host_name(host);
  return !state.loopback || name == "localhost" || name == "127.0.0.1" || name == "[::1]" ||
         name == state.options.host;
}

/// A browser always sends an Origin; a client that sends none is not a page of another site.
bool is_own_origin(std::string_view origin, std::string_view host) {
  return origin.empty() || origin == "http://" + std::string(host) ||
         origin == "https://" + std::string(host);
}

}  // namespace

void ServerState::deliver(Received message) {
  const bool is_message = message.kind == Received::Kind::message;
  {
    const std::lock_guard lock(received_mutex);
    if (is_message && received.size() >= most_received) {
      ++counters.refused_rate;
      return;
    }
    received.push_back(std::move(message));
  }
  if (is_message) ++counters.messages;
  received_condition.notify_all();
}

Connection::Connection(ServerState& state, Descriptor socket)
    : state_(state),
      socket_(std::move(socket)),
      last_received_(Clock::now()),
      deadline_(last_received_ + request_time),
      decoder_(state.options.max_message),
      allowance_(state.options.burst),
      last_message_(last_received_) {}

Connection::~Connection() {
  leave();
}

void Connection::drop() {
  leave();
  stage_ = Stage::over;
}

/// No longer a client.
void Connection::leave() {
  if (stage_ != Stage::client) return;
  stage_ = Stage::closing;
  deadline_ = Clock::now() + closing_time;
  waiting_.clear();
  waiting_bytes_ = 0;
  frame_ = nullptr;
  --state_.clients;
  state_.deliver({Received::Kind::left, client_, {}});
}

void Connection::check_time(Clock::time_point now) {
  if (stage_ != Stage::client) {
    if (now > deadline_) drop();
    return;
  }
  if (now - last_received_ > silent_time) return drop();
  if (now - last_received_ > ping_time && !pinged_) {
    pinged_ = true;
    control_ += websocket::frame_head(websocket::Opcode::ping, 0);
    write();
  }
}

void Connection::read() {
  char buffer[16384];
  const ssize_t got = ::recv(descriptor(), buffer, sizeof buffer, 0);
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (got <= 0) {
    if (stage_ == Stage::request && !request_.empty()) ++state_.counters.refused_other;
    return drop();
  }
  const std::string_view bytes(buffer, static_cast<std::size_t>(got));
  if (stage_ == Stage::request) {
    request_ += bytes;
    read_request();
  } else if (stage_ == Stage::client) {
    last_received_ = Clock::now();
    pinged_ = false;
    decoder_.append(bytes);
    read_messages();
  }
}

void Connection::read_request() {
  const auto end = request_.find("\r\n\r\n");
  if (std::min(end, request_.size()) > most_request) {
    ++state_.counters.refused_other;
    return drop();
  }
  if (end == std::string::npos) return;
  const auto request = parse_request(std::string_view(request_).substr(0, end));
  if (!request) {
    ++state_.counters.refused_other;
    return drop();
  }
  request_.erase(0, end + 4);
  answer(*request);
}

void Connection::answer(const HttpRequest& request) {
  AtomicCounters& counters = state_.counters;
  if (!is_own_host(state_, request.field("host"))) {
    ++counters.refused_origin;
    return refuse("403 Forbidden", "this host name is not served here\n");
  }
  if (!state_.options.token.empty() && !same_secret(request.query("token"), state_.options.token)) {
    ++counters.refused_token;
    return refuse("401 Unauthorized", "open the printed address, which contains the token\n");
  }
  if (request.is_upgrade() && request.path() == "/ws") return become_client(request);
  if (request.method != "GET" && request.method != "HEAD") {
    ++counters.refused_other;
    return refuse("405 Method Not Allowed", "only GET and HEAD are supported\n");
  }
  const auto found = state_.resources.find(request.path());
  if (request.is_upgrade() || found == state_.resources.end()) {
    ++counters.refused_other;
    return refuse("404 Not Found", "not found\n");
  }
  respond("200 OK", found->second, request.method == "HEAD");
}

void Connection::become_client(const HttpRequest& request) {
  if (!is_own_origin(request.field("origin"), request.field("host"))) {
    ++state_.counters.refused_origin;
    return refuse("403 Forbidden", "pages of another origin are not served\n");
  }
  if (request.field("sec-websocket-version") != "13" || request.field("sec-websocket-key").size() != 24) {
    ++state_.counters.refused_other;
    return refuse("400 Bad Request", "must be a WebSocket of version 13\n");
  }
  if (state_.clients >= state_.options.max_clients) {
    ++state_.counters.refused_other;
    return refuse("503 Service Unavailable", "too many clients\n");
  }
  prepare_for_frames(socket_);
  stage_ = Stage::client;
  client_ = state_.next_client++;
  last_received_ = Clock::now();
  ++state_.clients;
  ++state_.counters.connections;
  control_ =
      "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Accept: " +
      websocket::accept_key(request.field("sec-websocket-key")) + "\r\n\r\n";
  state_.deliver({Received::Kind::joined, client_, {}});
  write();
  decoder_.append(request_);
  read_messages();
}

void Connection::respond(std::string_view status, const Resource& resource, bool head_only) {
  control_ = http_response(status, resource, head_only);
  stage_ = Stage::closing;
  deadline_ = Clock::now() + request_time;
  write();
}

void Connection::refuse(std::string_view status, const char* reason) {
  respond(status, {"text/plain; charset=utf-8", "", reason}, false);
}

void Connection::read_messages() {
  while (stage_ == Stage::client && handle(decoder_.next())) {
  }
}

/// False where nothing more can be read now.
bool Connection::handle(websocket::Decoder::Event event) {
  using Event = websocket::Decoder::Event;
  switch (event) {
    case Event::none:
      return false;
    case Event::text:
    case Event::binary:
      got_message(event == Event::text);
      return true;
    case Event::pong:
      return true;
    case Event::ping:
      // A client that does not read its answers gets no more of them.
      if (control_.size() < most_control)
        control_ +=
            websocket::frame_head(websocket::Opcode::pong, decoder_.payload().size()) + decoder_.payload();
      write();
      return true;
    case Event::close:
      close_with(websocket::CloseCode::normal);
      return false;
    case Event::too_big:
      ++state_.counters.refused_size;
      close_with(websocket::CloseCode::too_big);
      return false;
    case Event::violation:
      ++state_.counters.refused_other;
      close_with(websocket::CloseCode::protocol_error);
      return false;
    case Event::invalid_text:
      ++state_.counters.refused_other;
      close_with(websocket::CloseCode::invalid_text);
      return false;
  }
  return false;
}

void Connection::got_message(bool text) {
  if (!within_rate())
    ++state_.counters.refused_rate;
  else if (!text)
    ++state_.counters.refused_other;
  else
    state_.deliver({Received::Kind::message, client_, decoder_.payload()});
}

/// A bucket of messages that is refilled over time.
bool Connection::within_rate() {
  const auto now = Clock::now();
  const double passed = std::chrono::duration<double>(now - last_message_).count();
  last_message_ = now;
  allowance_ = std::min(state_.options.burst, allowance_ + passed * state_.options.messages_per_second);
  if (allowance_ < 1) return false;
  allowance_ -= 1;
  return true;
}

void Connection::close_with(websocket::CloseCode code) {
  leave();
  control_ += websocket::close_frame(code);
  write();
}

void Connection::queue(const Message& message) {
  if (stage_ != Stage::client) return;
  if (waiting_.size() >= most_waiting || waiting_bytes_ + message.body->size() > most_waiting_bytes)
    return drop();
  waiting_bytes_ += message.body->size();
  waiting_.push_back(message);
  write();
}

void Connection::offer(const std::shared_ptr<const std::string>& frame) {
  if (stage_ != Stage::client) return;
  if (frame_) ++state_.counters.frames_dropped;
  frame_ = frame;
  write();
}

void Connection::start_next_output() {
  head_.clear();
  body_ = nullptr;
  sent_ = 0;
  sending_frame_ = false;
  if (!control_.empty()) {
    head_.swap(control_);
    return;
  }
  Message message;
  if (!waiting_.empty()) {
    message = std::move(waiting_.front());
    waiting_.pop_front();
    waiting_bytes_ -= message.body->size();
  } else if (frame_) {
    message = {std::move(frame_), true};
    frame_ = nullptr;
    sending_frame_ = true;
  } else {
    return;
  }
  using websocket::Opcode;
  body_ = std::move(message.body);
  head_ = websocket::frame_head(message.binary ? Opcode::binary : Opcode::text, body_->size());
}

void Connection::write() {
  while (stage_ != Stage::over) {
    if (!has_output()) start_next_output();
    if (!has_output()) break;
    const bool in_head = sent_ < head_.size();
    const std::string& bytes = in_head ? head_ : *body_;
    const std::size_t from = in_head ? sent_ : sent_ - head_.size();
    const int more = in_head && body_ ? MSG_MORE : 0;
    const ssize_t sent = ::send(descriptor(), bytes.data() + from, bytes.size() - from, MSG_NOSIGNAL | more);
    if (sent < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (sent < 0) return drop();
    sent_ += static_cast<std::size_t>(sent);
    if (!has_output() && sending_frame_) ++state_.counters.frames_sent;
  }
  // All is sent; the other side closes once it has read it.
  if (stage_ == Stage::closing) ::shutdown(descriptor(), SHUT_WR);
}

}  // namespace slalom::view
