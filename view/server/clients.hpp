#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "view/server/server.hpp"

namespace slalom::view {

/// A connected WebSocket.
class Client {
 public:
  virtual ~Client() = default;
  /// Sends a message after those that are waiting; disconnects the client if too many are.
  virtual void send(const Message& message) = 0;
  /// Sends a frame once no message is waiting; a newer frame replaces it until then.
  virtual void offer(const std::shared_ptr<const std::string>& frame) = 0;
};

/// The connected clients by their numbers. Used by the server's thread only, except for `size`.
class Clients {
 public:
  void add(std::uint64_t id, std::shared_ptr<Client> client);
  void remove(std::uint64_t id);
  void clear();
  int size() const noexcept { return size_; }

  /// Sends a message to one client; nothing happens if it has left.
  void send(std::uint64_t id, const Message& message);
  void broadcast(const Message& message);
  void offer(const std::shared_ptr<const std::string>& frame);
  /// Offers a frame to one client; nothing happens if it has left.
  void offer(std::uint64_t id, const std::shared_ptr<const std::string>& frame);

 private:
  std::map<std::uint64_t, std::shared_ptr<Client>> clients_;
  std::atomic<int> size_{0};
};

}  // namespace slalom::view
