#include "view/server/server.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "view/server/connection.hpp"

namespace slalom::view {

/// The thread that serves all connections, and what other threads hand to it.
struct Server::Implementation {
  /// A message for one client, or for all (0).
  struct Directed {
    std::uint64_t client = 0;
    Message message;
  };

  ServerState state;
  Descriptor listener, wake;
  std::vector<std::unique_ptr<Connection>> connections;

  std::mutex mutex;  ///< of the three below
  std::vector<Directed> outbox;
  std::shared_ptr<const std::string> frame;
  bool stopped = false;

  std::thread thread;

  Implementation(const ServerOptions& options, std::map<std::string, Resource> resources)
      : wake(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    state.options = options;
    state.resources = std::move(resources);
    state.loopback = is_loopback(options.host);
    listener = listen_on(options.host, options.port);
    thread = std::thread([this] { run(); });
  }

  ~Implementation() {
    {
      const std::lock_guard lock(mutex);
      stopped = true;
    }
    ring();
    thread.join();
  }

  /// Wakes the thread.
  void ring() const {
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = ::write(wake.number(), &one, sizeof one);
  }

  void run();
  bool hand_out();
  void accept();
  void serve(const std::vector<pollfd>& polled);
  template <class Call>
  void guarded(Connection& connection, const Call& call);
};

/// Whatever one client brings about, the others are still served.
template <class Call>
void Server::Implementation::guarded(Connection& connection, const Call& call) {
  try {
    call(connection);
  } catch (const std::exception&) {
    ++state.counters.refused_other;
    connection.drop();
  }
}

void Server::Implementation::run() {
  std::vector<pollfd> polled;
  while (hand_out()) {
    std::erase_if(connections, [](const auto& each) { return each->is_over(); });
    polled = {{wake.number(), POLLIN, 0}, {listener.number(), POLLIN, 0}};
    for (const auto& each : connections)
      polled.push_back(
          {each->descriptor(), static_cast<short>(POLLIN | (each->has_output() ? POLLOUT : 0)), 0});
    // Once a second to look for connections that take too long.
    ::poll(polled.data(), polled.size(), connections.empty() ? -1 : 1000);
    std::uint64_t rung = 0;
    [[maybe_unused]] const auto emptied = ::read(wake.number(), &rung, sizeof rung);
    serve(polled);
    if (polled[1].revents != 0) accept();
  }
  connections.clear();
}

void Server::Implementation::serve(const std::vector<pollfd>& polled) {
  const auto now = Clock::now();
  for (std::size_t i = 0; i < connections.size(); ++i) {
    const short events = polled[i + 2].revents;
    guarded(*connections[i], [&](Connection& connection) {
      if ((events & POLLOUT) != 0) connection.write();
      if ((events & (POLLIN | POLLHUP | POLLERR)) != 0 && !connection.is_over()) connection.read();
      if (!connection.is_over()) connection.check_time(now);
    });
  }
}

void Server::Implementation::accept() {
  while (true) {
    Descriptor socket = accept_connection(listener);
    if (socket.number() < 0) return;
    if (std::ssize(connections) < 4 * state.options.max_clients)
      connections.push_back(std::make_unique<Connection>(state, std::move(socket)));
    else
      ++state.counters.refused_other;
  }
}

/// Passes on what other threads have handed over. False once the server is stopped.
bool Server::Implementation::hand_out() {
  std::vector<Directed> messages;
  std::shared_ptr<const std::string> latest;
  {
    const std::lock_guard lock(mutex);
    if (stopped) return false;
    messages.swap(outbox);
    latest.swap(frame);
  }
  for (const Directed& each : messages)
    for (const auto& connection : connections)
      if (connection->client() != 0 && (each.client == 0 || each.client == connection->client()))
        guarded(*connection, [&](Connection& to) { to.queue(each.message); });
  if (!latest) return true;
  for (const auto& connection : connections) guarded(*connection, [&](Connection& to) { to.offer(latest); });
  return true;
}

Server::Server(const ServerOptions& options, std::map<std::string, Resource> resources)
    : implementation_(std::make_unique<Implementation>(options, std::move(resources))) {}
Server::~Server() = default;

std::uint16_t Server::port() const noexcept {
  return bound_port(implementation_->listener);
}

void Server::publish(std::shared_ptr<const std::string> frame) {
  bool waiting = false;
  {
    const std::lock_guard lock(implementation_->mutex);
    waiting = implementation_->frame != nullptr;
    implementation_->frame = std::move(frame);
  }
  if (!waiting) implementation_->ring();
}

void Server::send(std::uint64_t client, Message message) {
  {
    const std::lock_guard lock(implementation_->mutex);
    implementation_->outbox.push_back({client, std::move(message)});
  }
  implementation_->ring();
}

void Server::broadcast(Message message) {
  send(0, std::move(message));
}

std::vector<Received> Server::take() {
  const std::lock_guard lock(implementation_->state.received_mutex);
  return std::exchange(implementation_->state.received, {});
}

void Server::wait(std::chrono::nanoseconds at_most) {
  ServerState& state = implementation_->state;
  std::unique_lock lock(state.received_mutex);
  state.received_condition.wait_for(lock, at_most, [&state] { return !state.received.empty(); });
}

int Server::clients() const noexcept {
  return implementation_->state.clients;
}

ServerCounters Server::counters() const {
  const AtomicCounters& c = implementation_->state.counters;
  return {c.connections,   c.messages,     c.frames_sent,  c.frames_dropped, c.refused_origin,
          c.refused_token, c.refused_size, c.refused_rate, c.refused_other};
}

}  // namespace slalom::view
