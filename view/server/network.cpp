#include "view/server/network.hpp"

#include <utility>  // before asio, which needs it in C++20 and does not include it

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <deque>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "view/server/http_connection.hpp"

namespace slalom::view {
namespace {

constexpr std::chrono::milliseconds retry_time{100};  // after a connection could not be accepted

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
  asio::steady_timer retry{context};
  std::deque<std::weak_ptr<HttpConnection>>
      waiting;  ///< connections by age, those whose request has arrived too
  std::uint16_t port = 0;
  std::thread thread;

  explicit Implementation(ServerState& shared) : state(shared) {
    listen();
    accept();
    try {
      thread = std::thread([this] { run(); });
    } catch (const std::system_error& error) {
      throw std::runtime_error("the system cannot start the thread of the server (" + error.code().message() +
                               ")");
    }
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
      if (error) return accept_later();
      if (state.open_connections < 4 * state.options.max_clients || drop_oldest())
        begin(std::move(socket));
      else
        ++state.counters.refused_other;
      accept();
    });
  }

  /// Accepting fails at once and again while the process has no file descriptor left.
  void accept_later() {
    ++state.counters.refused_other;
    retry.expires_after(retry_time);
    retry.async_wait([this](error_code error) {
      if (!error) accept();
    });
  }

  void begin(tcp::socket&& socket) {
    while (!waiting.empty() && !is_waiting(waiting.front())) waiting.pop_front();
    const auto connection = std::make_shared<HttpConnection>(state, std::move(socket));
    waiting.push_back(connection);
    connection->begin();
  }

  static bool is_waiting(const std::weak_ptr<HttpConnection>& connection) {
    const auto alive = connection.lock();
    return alive && alive->is_waiting();
  }

  /// Closes the connection that has waited longest for its request, so that slow clients cannot keep others
  /// out. False if there is none.
  bool drop_oldest() {
    while (!waiting.empty()) {
      const auto oldest = waiting.front().lock();
      waiting.pop_front();
      if (!oldest || !oldest->is_waiting()) continue;
      oldest->drop();
      return true;
    }
    return false;
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
