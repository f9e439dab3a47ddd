#include "view/server/websocket.hpp"

#include <array>
#include <bit>

#include "view/recording/encodings.hpp"

namespace slalom::view::websocket {
namespace {

/// SHA-1 (RFC 3174), which the handshake prescribes; no secret depends on it.
std::string sha1(std::string_view text) {
  std::array<std::uint32_t, 5> h = {0x67452301u, 0xEFCDAB89u, 0x98BADCFEu, 0x10325476u, 0xC3D2E1F0u};
  std::string padded(text);
  padded += '\x80';
  while (padded.size() % 64 != 56) padded += '\0';
  const std::uint64_t bits = 8 * static_cast<std::uint64_t>(text.size());
  for (int shift = 56; shift >= 0; shift -= 8) padded += static_cast<char>(bits >> shift & 255u);
  for (std::size_t block = 0; block < padded.size(); block += 64) {
    std::array<std::uint32_t, 80> w{};
    for (std::size_t i = 0; i < 64; ++i)
      w[i / 4] = w[i / 4] << 8 | static_cast<unsigned char>(padded[block + i]);
    for (std::size_t i = 16; i < 80; ++i) w[i] = std::rotl(w[i - 3] ^ w[i - 8] ^ w[i - 14] ^ w[i - 16], 1);
    auto [a, b, c, d, e] = h;
    for (std::size_t i = 0; i < 80; ++i) {
      const std::uint32_t f = i < 20   ? ((b & c) | (~b & d)) + 0x5A827999u
                              : i < 40 ? (b ^ c ^ d) + 0x6ED9EBA1u
                              : i < 60 ? ((b & c) | (b & d) | (c & d)) + 0x8F1BBCDCu
                                       : (b ^ c ^ d) + 0xCA62C1D6u;
      const std::uint32_t next = std::rotl(a, 5) + f + e + w[i];
      e = d;
      d = c;
      c = std::rotl(b, 30);
      b = a;
      a = next;
    }
    h = {h[0] + a, h[1] + b, h[2] + c, h[3] + d, h[4] + e};
  }
  std::string digest;
  for (const std::uint32_t word : h)
    for (int shift = 24; shift >= 0; shift -= 8) digest += static_cast<char>(word >> shift & 255u);
  return digest;
}

/// Whether a text is UTF-8 (RFC 3629): no overlong forms, no surrogates, nothing above U+10FFFF.
bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i++]);
    if (first < 0x80) continue;
    const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : 1;
    if (first < 0xC2 || first > 0xF4 || text.size() - i < static_cast<std::size_t>(more)) return false;
    std::uint32_t code = first & (0x3Fu >> more);
    for (int k = 0; k < more; ++k) {
      const auto byte = static_cast<unsigned char>(text[i++]);
      if ((byte & 0xC0u) != 0x80u) return false;
      code = code << 6 | (byte & 0x3Fu);
    }
    if (code < (more == 1   ? 0x80u
                : more == 2 ? 0x800u
                            : 0x10000u) ||
        code > 0x10FFFFu || (code >= 0xD800u && code <= 0xDFFFu))
      return false;
  }
  return true;
}

bool is_control(Opcode opcode) {
  return opcode >= Opcode::close;
}

}  // namespace

std::string accept_key(std::string_view key) {
  return base64(sha1(std::string(key) + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"));
}

std::string frame_head(Opcode opcode, std::size_t size) {
  std::string head(1, static_cast<char>(0x80u | static_cast<unsigned>(opcode)));
  const int digits = size < 126 ? 0 : size < 65536 ? 2 : 8;
  head += static_cast<char>(digits == 0 ? size : digits == 2 ? 126 : 127);
  for (int i = digits - 1; i >= 0; --i) head += static_cast<char>(std::uint64_t{size} >> 8 * i & 255u);
  return head;
}

std::string close_frame(CloseCode code) {
  const auto number = static_cast<unsigned>(code);
  return frame_head(Opcode::close, 2) + static_cast<char>(number >> 8) + static_cast<char>(number & 255u);
}

struct Decoder::Frame {
  bool final = false, masked = false;
  unsigned reserved = 0;
  Opcode opcode{};
  std::uint64_t length = 0;
  std::size_t head = 0;  ///< bytes before the payload
};

/// False as long as the head is incomplete.
bool Decoder::read_head(Frame& frame) const {
  const auto byte = [this](std::size_t i) { return static_cast<unsigned char>(received_[i]); };
  if (received_.size() < 2) return false;
  frame.final = byte(0) >> 7 != 0;
  frame.reserved = byte(0) >> 4 & 7u;
  frame.opcode = static_cast<Opcode>(byte(0) & 15u);
  frame.masked = byte(1) >> 7 != 0;
  frame.length = byte(1) & 127u;
  const std::size_t digits = frame.length == 126 ? 2 : frame.length == 127 ? 8 : 0;
  frame.head = 2 + digits + (frame.masked ? 4 : 0);
  if (received_.size() < frame.head) return false;
  if (digits > 0) frame.length = 0;
  for (std::size_t i = 0; i < digits; ++i) frame.length = frame.length << 8 | byte(2 + i);
  return true;
}

bool Decoder::is_valid(const Frame& frame) const {
  if (frame.reserved != 0 || !frame.masked) return false;
  if (is_control(frame.opcode)) return frame.opcode <= Opcode::pong && frame.final && frame.length <= 125;
  if (frame.opcode > Opcode::binary) return false;
  // A message in fragments is continued; otherwise one begins.
  return (frame.opcode == Opcode::continuation) == (message_opcode_ != Opcode::continuation);
}

Decoder::Event Decoder::message(const Frame& frame) {
  if (frame.opcode != Opcode::continuation) message_opcode_ = frame.opcode;
  message_ += payload_;
  if (!frame.final) return Event::none;
  payload_ = std::move(message_);
  message_.clear();
  const bool text = message_opcode_ == Opcode::text;
  message_opcode_ = Opcode::continuation;
  if (!text) return Event::binary;
  return is_utf8(payload_) ? Event::text : Event::invalid_text;
}

Decoder::Event Decoder::next() {
  for (Frame frame; read_head(frame); frame = {}) {
    if (!is_valid(frame)) return Event::violation;
    if (!is_control(frame.opcode) && frame.length > max_message_ - message_.size()) return Event::too_big;
    if (received_.size() - frame.head < frame.length) return Event::none;
    const auto length = static_cast<std::size_t>(frame.length);
    payload_ = received_.substr(frame.head, length);
    for (std::size_t i = 0; i < length; ++i)
      payload_[i] = static_cast<char>(payload_[i] ^ received_[frame.head - 4 + i % 4]);
    received_.erase(0, frame.head + length);
    if (frame.opcode == Opcode::close) return Event::close;
    if (frame.opcode == Opcode::ping) return Event::ping;
    if (frame.opcode == Opcode::pong) return Event::pong;
    if (const Event event = message(frame); event != Event::none) return event;
  }
  return Event::none;
}

}  // namespace slalom::view::websocket
