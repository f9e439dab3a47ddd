#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

/// The WebSocket protocol (RFC 6455), server's side, without extensions.
namespace slalom::view::websocket {

/// Sec-WebSocket-Accept for a Sec-WebSocket-Key: base64(SHA-1(key + GUID)), section 4.2.2.
std::string accept_key(std::string_view key);

enum class Opcode : std::uint8_t { continuation = 0, text = 1, binary = 2, close = 8, ping = 9, pong = 10 };

/// Reasons to close a connection, section 7.4.1.
enum class CloseCode : std::uint16_t {
  normal = 1000,
  protocol_error = 1002,
  invalid_text = 1007,
  too_big = 1009
};

/// The head of an unmasked frame that holds a whole message of `size` bytes.
std::string frame_head(Opcode opcode, std::size_t size);
/// A whole close frame.
std::string close_frame(CloseCode code);

/// Takes messages out of a stream of bytes from a client.
class Decoder {
 public:
  enum class Event { none, text, binary, ping, pong, close, violation, invalid_text, too_big };

  /// Messages of more than `max_message` bytes are an error.
  explicit Decoder(std::size_t max_message) : max_message_(max_message) {}

  void append(std::string_view bytes) { received_ += bytes; }

  /// The next message or error; `none` as long as more bytes are needed. After an error nothing follows.
  Event next();

  /// Of the message that `next` has returned.
  const std::string& payload() const noexcept { return payload_; }

 private:
  struct Frame;
  bool read_head(Frame& frame) const;
  bool is_valid(const Frame& frame) const;
  Event message(const Frame& frame);

  std::size_t max_message_;
  std::string received_;
  std::string message_;      ///< fragments so far
  Opcode message_opcode_{};  ///< of the message in fragments; continuation: none has begun
  std::string payload_;
};

}  // namespace slalom::view::websocket
