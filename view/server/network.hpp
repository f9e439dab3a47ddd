#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "view/server/server_state.hpp"

namespace slalom::view {

/// The server's thread: accepts connections, answers HTTP requests and serves WebSockets. The only part of
/// the live view that uses Boost.Asio and Boost.Beast.
class Network {
 public:
  /// Starts to listen on host and port of the options; `state` must outlive it. Throws std::runtime_error if
  /// the port cannot be bound.
  explicit Network(ServerState& state);
  /// Closes all connections.
  ~Network();
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  std::uint16_t port() const noexcept;
  /// Calls a function on the server's thread, after those posted before.
  void post(std::function<void()> call);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace slalom::view
