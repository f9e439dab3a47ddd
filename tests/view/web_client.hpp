#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cerrno>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>

#include "view/server/server.hpp"

namespace slalom::testing {

/// A web client that sends what it is told to send, well-formed or not.
class WebClient {
 public:
  explicit WebClient(std::uint16_t port, int receive_buffer = 0) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    const timeval patience{60, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    if (receive_buffer > 0)
      setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 && !connected())
      throw std::system_error(errno, std::generic_category(), "no connection");
  }
  ~WebClient() { close(socket_); }
  WebClient(const WebClient&) = delete;
  WebClient& operator=(const WebClient&) = delete;

  /// False once the other side has closed.
  bool say(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }

  /// Tells the server that nothing more will be sent.
  void end() { shutdown(socket_, SHUT_WR); }

  /// A GET, or with `upgrade` the opening of a WebSocket; the answer's head.
  std::string get(const std::string& target, bool upgrade = false, const std::string& host = "127.0.0.1",
                  const std::string& origin = "") {
    std::string request = "GET " + target + " HTTP/1.1\r\nHost: " + host + "\r\n";
    if (!origin.empty()) request += "Origin: " + origin + "\r\n";
    if (upgrade)
      request +=
          "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
          "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
    say(request + "\r\n");
    while (received_.find("\r\n\r\n") == std::string::npos && more()) {
    }
    const std::size_t end = received_.find("\r\n\r\n");
    if (end == std::string::npos) return received_;
    const std::string head = received_.substr(0, end);
    received_.erase(0, end + 4);
    return head;
  }

  /// A message in one masked frame; `opcode` 1 is text, 2 binary.
  bool send_message(std::string_view text, unsigned opcode = 1) { return send_frame(0x80u | opcode, text); }

  /// A masked frame; `first` is its first byte: 0x80 for the last frame of a message, and the opcode.
  bool send_frame(unsigned first, std::string_view payload) {
    std::string frame(1, static_cast<char>(first));
    if (payload.size() < 126) {
      frame += static_cast<char>(0x80u | payload.size());
    } else if (payload.size() < 65536) {
      frame += static_cast<char>(0x80u | 126u);
      frame += static_cast<char>(payload.size() >> 8);
      frame += static_cast<char>(payload.size() & 255);
    } else {
      frame += static_cast<char>(0x80u | 127u);
      for (int shift = 56; shift >= 0; shift -= 8) frame += static_cast<char>(payload.size() >> shift & 255);
    }
    const char mask[4] = {1, 2, 3, 4};
    frame.append(mask, 4);
    for (std::size_t i = 0; i < payload.size(); ++i) frame += static_cast<char>(payload[i] ^ mask[i % 4]);
    return say(frame);
  }

  struct Frame {
    unsigned opcode = 0;
    std::string payload;
  };

  /// The next frame; nothing if the connection ends or nothing comes.
  std::optional<Frame> next_frame() {
    if (!need(2)) return {};
    const unsigned opcode = byte(0) & 15u;
    std::size_t length = byte(1) & 127u, head = 2;
    if (length >= 126) {
      const std::size_t digits = length == 126 ? 2 : 8;
      if (!need(2 + digits)) return {};
      length = 0;
      for (std::size_t i = 0; i < digits; ++i) length = length << 8 | byte(2 + i);
      head += digits;
    }
    if (!need(head + length)) return {};
    Frame frame{opcode, received_.substr(head, length)};
    received_.erase(0, head + length);
    return frame;
  }

  /// The next message's payload; pings are skipped. Empty if nothing comes or the connection ends.
  std::string next_message() {
    while (const auto frame = next_frame()) {
      if (frame->opcode == 8) return {};
      if (frame->opcode <= 2) return frame->payload;
    }
    return {};
  }

  /// All that comes until the server closes the connection.
  std::string rest() {
    while (more()) {
    }
    return received_;
  }

 private:
  /// A signal, such as that of the timer of a fuzzer, interrupts `connect`, and the system connects all the
  /// same. Whether it has.
  bool connected() const {
    if (errno != EINTR) return false;
    pollfd wanted{socket_, POLLOUT, 0};
    while (poll(&wanted, 1, -1) < 0)
      if (errno != EINTR) return false;
    socklen_t size = sizeof errno;
    return getsockopt(socket_, SOL_SOCKET, SO_ERROR, &errno, &size) == 0 && errno == 0;
  }
  unsigned byte(std::size_t i) const { return static_cast<unsigned char>(received_[i]); }
  bool more() {
    char buffer[65536];
    ssize_t got = 0;
    do {
      got = recv(socket_, buffer, sizeof buffer, 0);
    } while (got < 0 && errno == EINTR);
    if (got <= 0) return false;
    received_.append(buffer, static_cast<std::size_t>(got));
    return true;
  }
  bool need(std::size_t bytes) {
    while (received_.size() < bytes)
      if (!more()) return false;
    return true;
  }

  int socket_;
  std::string received_;
};

/// A WebSocket that is open.
struct PageClient : WebClient {
  /// Opens it, and waits until the server has `clients`.
  explicit PageClient(const view::Server& server, int clients = 1, const std::string& target = "/ws",
                      int receive_buffer = 0)
      : WebClient(server.port(), receive_buffer) {
    get(target, true);
    for (int i = 0; i < 1000 && server.clients() < clients; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
};

}  // namespace slalom::testing
