#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace slalom::view {

/// A file descriptor that is closed when it goes out of scope; -1 is none.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) noexcept : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor();

  int number() const noexcept { return number_; }

 private:
  int number_;
};

/// A non-blocking TCP socket that listens on `host`, an IP address or "localhost", and `port`; 0 takes any
/// free port. Throws std::invalid_argument if the host is not an address, std::runtime_error if the port
/// cannot be bound.
Descriptor listen_on(const std::string& host, std::uint16_t port);

/// The port that a listening socket is bound to.
std::uint16_t bound_port(const Descriptor& listener);

/// The next connection, non-blocking; none if nobody waits.
Descriptor accept_connection(const Descriptor& listener);

/// Prepares the socket of a client that frames are sent to: no delay, and a small buffer, so that a slow
/// client does not see old frames.
void prepare_for_frames(const Descriptor& connection);

}  // namespace slalom::view
