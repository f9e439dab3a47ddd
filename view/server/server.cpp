#include "view/server/server.hpp"

#include <utility>  // before asio, which forgets it in C++20

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <unordered_map>

namespace slalom::view {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using beast::error_code;
using Clock = std::chrono::steady_clock;

constexpr std::size_t most_waiting = 256;             // messages kept for a client in order
constexpr std::size_t most_waiting_bytes = 64 << 20;  // bytes of them
constexpr std::size_t most_received = 1024;
constexpr int send_buffer = 1 << 18;  // bytes; small, so that what a slow client sees is not old

/// Compares without saying by its duration how much was right.
bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  return difference == 0;
}

std::string_view query_value(std::string_view target, std::string_view key) {
  std::size_t at = target.find('?');
  while (at != std::string_view::npos) {
    const std::size_t end = target.find('&', at + 1);
    const std::string_view pair = target.substr(at + 1, end == std::string_view::npos ? end : end - at - 1);
    const std::size_t equals = pair.find('=');
    if (pair.substr(0, equals) == key && equals != std::string_view::npos) return pair.substr(equals + 1);
    at = end;
  }
  return {};
}

/// The name of a host without its port.
std::string_view host_name(std::string_view host) {
  if (!host.empty() && host.front() == '[') return host.substr(0, host.find(']') + 1);
  return host.substr(0, host.find(':'));
}

struct Counters {
  std::atomic<std::uint64_t> connections{0}, messages{0}, frames_sent{0}, frames_dropped{0},
      refused_origin{0}, refused_token{0}, refused_size{0}, refused_rate{0}, refused_other{0};
};

}  // namespace

bool is_loopback(const std::string& host) {
  if (host == "localhost") return true;
  error_code error;
  const auto address = asio::ip::make_address(host, error);
  if (error) throw std::invalid_argument("host '" + host + "' must be an IP address");
  return address.is_loopback();
}

struct Server::Implementation {
  class Client;
  class Visit;

  ServerOptions options;
  std::map<std::string, Resource> resources;
  bool loopback = true;
  Counters counters;
  std::atomic<int> client_count{0};
  int open_sockets = 0;
  std::uint64_t next_client = 1;
  asio::io_context context{1};  // after what its handlers touch when they are destroyed
  tcp::acceptor acceptor{context};
  std::uint16_t port = 0;
  std::unordered_map<std::uint64_t, std::shared_ptr<Client>> clients;

  std::mutex received_mutex;
  std::condition_variable received_condition;
  std::vector<Received> received;

  std::mutex frame_mutex;
  std::shared_ptr<const std::string> frame;

  std::thread thread;

  Implementation(const ServerOptions& o, std::map<std::string, Resource> r)
      : options(o), resources(std::move(r)) {
    loopback = is_loopback(options.host);
    const auto address = asio::ip::make_address(options.host == "localhost" ? "127.0.0.1" : options.host);
    const tcp::endpoint endpoint(address, options.port);
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
    accept();
    thread = std::thread([this] { run(); });
  }

  ~Implementation() {
    context.stop();
    thread.join();
  }

  void run() {
    while (!context.stopped()) {
      try {
        context.run();
      } catch (const std::exception&) {
        ++counters.refused_other;  // whatever one client brought about, the others are served on
      }
    }
  }

  void accept();

  bool host_is_ours(std::string_view host) const {
    if (!loopback) return true;  // any name may lead here; the token decides
    const std::string_view name = host_name(host);
    return name == "localhost" || name == "127.0.0.1" || name == "[::1]" || name == options.host;
  }

  void deliver(Received message) {
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

  void hand_out_frame();
};

/// One WebSocket. Lives as long as an operation is under way.
class Server::Implementation::Client : public std::enable_shared_from_this<Client> {
 public:
  Client(Implementation& server, beast::tcp_stream&& stream, std::uint64_t id)
      : server_(server), socket_(std::move(stream)), id_(id), allowance_(server.options.burst) {}

  ~Client() { --server_.open_sockets; }

  void open(http::request<http::empty_body> request) {
    request_ = std::move(request);
    socket_.set_option(
        websocket::stream_base::timeout{std::chrono::seconds(10), std::chrono::seconds(30), true});
    socket_.auto_fragment(false);  // a frame of the page is one frame of the protocol
    socket_.read_message_max(server_.options.max_message);
    socket_.async_accept(request_, [self = shared_from_this()](error_code error) {
      if (error) return;
      self->opened();
    });
  }

  void queue(const Message& message) {
    if (waiting_.size() >= most_waiting || waiting_bytes_ + message.body->size() > most_waiting_bytes) {
      close();
      return;
    }
    waiting_bytes_ += message.body->size();
    waiting_.push_back(message);
    write_next();
  }

  void offer(const std::shared_ptr<const std::string>& newest) {
    if (frame_) ++server_.counters.frames_dropped;
    frame_ = newest;
    write_next();
  }

 private:
  void opened() {
    error_code ignored;
    auto& socket = beast::get_lowest_layer(socket_).socket();
    socket.set_option(tcp::no_delay(true), ignored);
    socket.set_option(asio::socket_base::send_buffer_size(send_buffer), ignored);
    is_open_ = true;
    server_.clients.emplace(id_, shared_from_this());
    server_.client_count = static_cast<int>(server_.clients.size());
    ++server_.counters.connections;
    server_.deliver({Received::Kind::joined, id_, {}});
    read();
  }

  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) {
        if (error == websocket::error::message_too_big || error == websocket::error::buffer_overflow)
          ++self->server_.counters.refused_size;
        else if (error == websocket::condition::protocol_violation)
          ++self->server_.counters.refused_other;
        self->leave();
        return;
      }
      self->got_message();
      self->buffer_.clear();
      self->read();
    });
  }

  void got_message() {
    if (!may_speak()) {
      ++server_.counters.refused_rate;
    } else if (!socket_.got_text()) {
      ++server_.counters.refused_other;
    } else {
      server_.deliver({Received::Kind::message, id_, beast::buffers_to_string(buffer_.data())});
    }
  }

  /// A bucket of messages that fills again with time.
  bool may_speak() {
    const auto now = Clock::now();
    const double passed = std::chrono::duration<double>(now - last_message_).count();
    last_message_ = now;
    allowance_ = std::min(server_.options.burst, allowance_ + passed * server_.options.messages_per_second);
    if (allowance_ < 1) return false;
    allowance_ -= 1;
    return true;
  }

  void write_next() {
    if (writing_ || !is_open_) return;
    const bool is_frame = waiting_.empty();
    if (is_frame) {
      if (!frame_) return;
      under_way_ = {std::move(frame_), true};
      frame_ = nullptr;
    } else {
      under_way_ = std::move(waiting_.front());
      waiting_.pop_front();
      waiting_bytes_ -= under_way_.body->size();
    }
    writing_ = true;
    socket_.binary(under_way_.binary);
    socket_.async_write(asio::buffer(*under_way_.body),
                        [self = shared_from_this(), is_frame](error_code error, std::size_t) {
                          self->writing_ = false;
                          self->under_way_ = {};
                          if (error) return self->leave();
                          if (is_frame) ++self->server_.counters.frames_sent;
                          self->write_next();
                        });
  }

  void close() {
    error_code ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
    leave();
  }

  void leave() {
    if (!is_open_) return;
    is_open_ = false;
    waiting_.clear();
    frame_ = nullptr;
    server_.clients.erase(id_);
    server_.client_count = static_cast<int>(server_.clients.size());
    server_.deliver({Received::Kind::left, id_, {}});
  }

  Implementation& server_;
  websocket::stream<beast::tcp_stream> socket_;
  std::uint64_t id_;
  http::request<http::empty_body> request_;
  beast::flat_buffer buffer_;
  std::deque<Message> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::shared_ptr<const std::string> frame_;
  Message under_way_;
  bool writing_ = false;
  bool is_open_ = false;
  double allowance_;
  Clock::time_point last_message_ = Clock::now();
};

/// One HTTP request, answered or turned into a client.
class Server::Implementation::Visit : public std::enable_shared_from_this<Visit> {
 public:
  Visit(Implementation& server, tcp::socket&& socket) : server_(server), stream_(std::move(socket)) {
    ++server_.open_sockets;
    parser_.header_limit(8192);
    parser_.body_limit(0);
  }
  ~Visit() {
    if (!handed_over_) --server_.open_sockets;
  }

  void begin() {
    stream_.expires_after(std::chrono::seconds(10));
    http::async_read(stream_, buffer_, parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) {
        if (error != http::error::end_of_stream && error != beast::error::timeout)
          ++self->server_.counters.refused_other;
        return;
      }
      self->answer();
    });
  }

 private:
  void answer() {
    const auto& request = parser_.get();
    const std::string_view target(request.target().data(), request.target().size());
    const std::string path(target.substr(0, target.find('?')));
    const std::string_view host = field(http::field::host);
    const bool upgrade = websocket::is_upgrade(request);
    if (!server_.host_is_ours(host)) {
      ++server_.counters.refused_origin;
      return refuse(http::status::forbidden, "this host name is not served here\n");
    }
    if (!server_.options.token.empty() && !same_secret(query_value(target, "token"), server_.options.token)) {
      ++server_.counters.refused_token;
      return refuse(http::status::unauthorized, "the token of the address that was printed is needed\n");
    }
    if (upgrade && path == "/ws") return become_client(host);
    if (request.method() != http::verb::get && request.method() != http::verb::head) {
      ++server_.counters.refused_other;
      return refuse(http::status::method_not_allowed, "only GET is answered\n");
    }
    const auto found = server_.resources.find(path);
    if (upgrade || found == server_.resources.end()) {
      ++server_.counters.refused_other;
      return refuse(http::status::not_found, "there is nothing here\n");
    }
    serve(found->second);
  }

  void become_client(std::string_view host) {
    const std::string_view origin = field(http::field::origin);
    // A browser always sends an Origin; what sends none is no page of another site.
    const bool ours =
        origin.empty() || origin == "http://" + std::string(host) || origin == "https://" + std::string(host);
    if (!ours) {
      ++server_.counters.refused_origin;
      return refuse(http::status::forbidden, "pages of another origin are not served\n");
    }
    if (server_.client_count >= server_.options.max_clients) {
      ++server_.counters.refused_other;
      return refuse(http::status::service_unavailable, "too many clients\n");
    }
    stream_.expires_never();
    handed_over_ = true;
    const auto client = std::make_shared<Client>(server_, std::move(stream_), server_.next_client++);
    const auto& got = parser_.get();
    http::request<http::empty_body> request(got.method(), got.target(), got.version());
    for (const auto& each : got) request.insert(each.name_string(), each.value());
    client->open(std::move(request));
  }

  std::string_view field(http::field name) const {
    const auto value = parser_.get()[name];
    return {value.data(), value.size()};
  }

  void serve(const Resource& resource) {
    http::response<http::string_body> response(http::status::ok, 11);
    response.set(http::field::content_type, resource.type);
    if (!resource.encoding.empty()) response.set(http::field::content_encoding, resource.encoding);
    response.set("Content-Security-Policy",
                 "default-src 'self' 'unsafe-inline' data: blob:; connect-src 'self' ws: wss:; "
                 "frame-ancestors 'none'");
    response.body() = resource.body;
    finish(std::move(response));
  }

  void refuse(http::status status, const char* why) {
    http::response<http::string_body> response(status, 11);
    response.set(http::field::content_type, "text/plain; charset=utf-8");
    response.body() = why;
    finish(std::move(response));
  }

  void finish(http::response<http::string_body> response) {
    response.set(http::field::cache_control, "no-store");
    response.set("X-Content-Type-Options", "nosniff");
    response.set("Referrer-Policy", "no-referrer");
    response.keep_alive(false);
    response.prepare_payload();
    if (parser_.get().method() == http::verb::head) response.body().clear();
    response_ = std::move(response);
    http::async_write(stream_, response_, [self = shared_from_this()](error_code, std::size_t) {
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  Implementation& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{16384};
  http::request_parser<http::string_body> parser_;
  http::response<http::string_body> response_;
  bool handed_over_ = false;
};

void Server::Implementation::accept() {
  acceptor.async_accept([this](error_code error, tcp::socket socket) {
    if (!error) {
      if (open_sockets < 4 * options.max_clients)
        std::make_shared<Visit>(*this, std::move(socket))->begin();
      else
        ++counters.refused_other;
    }
    if (acceptor.is_open()) accept();
  });
}

void Server::Implementation::hand_out_frame() {
  std::shared_ptr<const std::string> latest;
  {
    const std::lock_guard lock(frame_mutex);
    latest.swap(frame);
  }
  if (!latest) return;
  const auto all = clients;  // offering may end a client
  for (const auto& [id, client] : all) client->offer(latest);
}

Server::Server(const ServerOptions& options, std::map<std::string, Resource> resources)
    : implementation_(std::make_unique<Implementation>(options, std::move(resources))) {}
Server::~Server() = default;

std::uint16_t Server::port() const noexcept {
  return implementation_->port;
}

void Server::publish(std::shared_ptr<const std::string> frame) {
  bool under_way = false;
  {
    const std::lock_guard lock(implementation_->frame_mutex);
    under_way = implementation_->frame != nullptr;
    implementation_->frame = std::move(frame);
  }
  if (!under_way) asio::post(implementation_->context, [i = implementation_.get()] { i->hand_out_frame(); });
}

void Server::send(std::uint64_t client, Message message) {
  asio::post(implementation_->context, [i = implementation_.get(), client, message = std::move(message)] {
    const auto found = i->clients.find(client);
    if (found == i->clients.end()) return;
    const auto kept = found->second;
    kept->queue(message);
  });
}

void Server::broadcast(Message message) {
  asio::post(implementation_->context, [i = implementation_.get(), message = std::move(message)] {
    auto all = i->clients;  // queueing may end a client
    for (const auto& [id, each] : all) each->queue(message);
  });
}

std::vector<Received> Server::take() {
  const std::lock_guard lock(implementation_->received_mutex);
  return std::exchange(implementation_->received, {});
}

void Server::wait(std::chrono::nanoseconds at_most) {
  std::unique_lock lock(implementation_->received_mutex);
  implementation_->received_condition.wait_for(lock, at_most,
                                               [this] { return !implementation_->received.empty(); });
}

int Server::clients() const noexcept {
  return implementation_->client_count;
}

ServerCounters Server::counters() const {
  const Counters& c = implementation_->counters;
  return {c.connections,   c.messages,     c.frames_sent,  c.frames_dropped, c.refused_origin,
          c.refused_token, c.refused_size, c.refused_rate, c.refused_other};
}

}  // namespace slalom::view
