#include "view/server/server.hpp"

#include <mutex>
#include <utility>

#include "view/server/network.hpp"
#include "view/server/server_state.hpp"

namespace slalom::view {

struct Server::Implementation {
  ServerState state;

  std::mutex frame_mutex;
  std::shared_ptr<const std::string> frame;  ///< published and not yet offered to the clients

  Network network{state};  // last, as its thread uses the others

  Implementation(const ServerOptions& options, std::map<std::string, Resource> resources)
      : state{options, std::move(resources)} {}

  void offer_frame() {
    std::shared_ptr<const std::string> latest;
    {
      const std::lock_guard lock(frame_mutex);
      latest.swap(frame);
    }
    if (latest) state.clients.offer(latest);
  }
};

Server::Server(const ServerOptions& options, std::map<std::string, Resource> resources)
    : implementation_(std::make_unique<Implementation>(options, std::move(resources))) {}
Server::~Server() = default;

std::uint16_t Server::port() const noexcept {
  return implementation_->network.port();
}

void Server::publish(std::shared_ptr<const std::string> frame) {
  bool is_posted = false;
  {
    const std::lock_guard lock(implementation_->frame_mutex);
    is_posted = implementation_->frame != nullptr;
    implementation_->frame = std::move(frame);
  }
  if (!is_posted) implementation_->network.post([i = implementation_.get()] { i->offer_frame(); });
}

void Server::publish(std::uint64_t client, std::shared_ptr<const std::string> frame) {
  implementation_->network.post([i = implementation_.get(), client, frame = std::move(frame)] {
    i->state.clients.offer(client, frame);
  });
}

void Server::send(std::uint64_t client, Message message) {
  implementation_->network.post([i = implementation_.get(), client, message = std::move(message)] {
    i->state.clients.send(client, message);
  });
}

void Server::broadcast(Message message) {
  implementation_->network.post(
      [i = implementation_.get(), message = std::move(message)] { i->state.clients.broadcast(message); });
}

std::vector<Received> Server::take() {
  return implementation_->state.inbox.take();
}

void Server::wait(std::chrono::nanoseconds at_most) {
  implementation_->state.inbox.wait(at_most);
}

int Server::clients() const noexcept {
  return implementation_->state.clients.size();
}

ServerCounters Server::counters() const {
  return implementation_->state.counters.snapshot();
}

}  // namespace slalom::view
