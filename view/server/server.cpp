#include "view/server/server.hpp"

#include <stdexcept>
#include <system_error>
#include <thread>

#include "view/server/connections.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

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

struct Server::Implementation {
  Connections all;
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  asio::steady_timer retry{context};
  std::uint16_t port = 0;
  std::thread thread;

  Implementation(const ServerOptions& options, std::map<std::string, Resource> resources)
      : all{options, std::move(resources)} {
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
    all.clients.clear();  // before the context, which their sockets use
  }

  void listen() {
    const ServerOptions& options = all.options;
    tcp::endpoint endpoint(parse_address(options.host), options.port);
    try {
      acceptor.open(endpoint.protocol());
      acceptor.set_option(asio::socket_base::reuse_address(true));
      error_code error;
      for (int left = options.port == 0 ? 1 : options.ports; left > 0; --left) {
        acceptor.bind(endpoint, error);
        if (error != asio::error::address_in_use) break;
        endpoint.port(static_cast<std::uint16_t>(endpoint.port() + 1));
      }
      if (error) throw boost::system::system_error(error);
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
      if (all.open < 4 * all.options.max_clients)
        std::make_shared<HttpConnection>(all, std::move(socket))->begin();
      else
        ++all.refused;
      accept();
    });
  }

  /// Accepting fails at once and again while the process has no file descriptor left.
  void accept_later() {
    ++all.refused;
    retry.expires_after(retry_time);
    retry.async_wait([this](error_code error) {
      if (!error) accept();
    });
  }

  void run() {
    while (!context.stopped()) {
      try {
        context.run();
      } catch (const std::exception&) {
        ++all.refused;  // a failure of one client must not end the others
      }
    }
  }

  /// Calls a function for one client, or for all with 0, on the server's thread, after those posted before.
  void post(std::uint64_t client, std::function<void(WebSocketClient&)> call) {
    asio::post(context, [this, client, call = std::move(call)] {
      const auto clients = all.clients;  // a call may remove a client
      for (const auto& [id, each] : clients)
        if (client == 0 || id == client) call(*each);
    });
  }
};

Server::Server(const ServerOptions& options, std::map<std::string, Resource> resources)
    : implementation_(std::make_unique<Implementation>(options, std::move(resources))) {}
Server::~Server() = default;

std::uint16_t Server::port() const noexcept {
  return implementation_->port;
}

void Server::publish(std::uint64_t client, std::shared_ptr<const std::string> frame) {
  implementation_->post(client, [frame = std::move(frame)](WebSocketClient& to) { to.offer(frame); });
}

void Server::send(std::uint64_t client, Message message) {
  implementation_->post(client, [message = std::move(message)](WebSocketClient& to) { to.send(message); });
}

std::vector<Received> Server::take() {
  const std::lock_guard lock(implementation_->all.mutex);
  return std::exchange(implementation_->all.inbox, {});
}

void Server::wait(std::chrono::nanoseconds at_most) {
  Connections& all = implementation_->all;
  std::unique_lock lock(all.mutex);
  all.arrived.wait_for(lock, at_most, [&] { return !all.inbox.empty(); });
}

int Server::clients() const noexcept {
  return implementation_->all.client_count;
}

ServerCounters Server::counters() const {
  const Connections& all = implementation_->all;
  return {all.messages, all.frames_dropped, all.refused};
}

std::string address_of(const Server& server, const ServerOptions& options, const std::string& path) {
  const bool is_v6 = options.host.find(':') != std::string::npos;
  return "http://" + (is_v6 ? "[" + options.host + "]" : options.host) + ":" + std::to_string(server.port()) +
         path + (options.token.empty() ? "" : "?token=" + options.token);
}

}  // namespace slalom::view
