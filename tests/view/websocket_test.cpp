// HTTP requests and WebSocket frames of the live view's server.
#include "view/server/websocket.hpp"

#include <gtest/gtest.h>

#include "view/server/http.hpp"

namespace slalom::view {
namespace {

using websocket::Decoder;
using websocket::Opcode;
using Event = Decoder::Event;

/// A frame of a client, masked.
std::string frame(unsigned first, const std::string& payload) {
  std::string bytes = websocket::frame_head(Opcode::text, payload.size());
  bytes[0] = static_cast<char>(first);
  bytes[1] = static_cast<char>(bytes[1] | '\x80');
  const char mask[] = {3, 1, 4, 1};
  bytes.append(mask, 4);
  for (std::size_t i = 0; i < payload.size(); ++i) bytes += static_cast<char>(payload[i] ^ mask[i % 4]);
  return bytes;
}

Event decode(const std::string& bytes, std::size_t most = 1000) {
  Decoder decoder(most);
  decoder.append(bytes);
  return decoder.next();
}

TEST(WebSocket, AcceptKeyIsThatOfTheRfc) {
  EXPECT_EQ(websocket::accept_key("dGhlIHNhbXBsZSBub25jZQ=="), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
  EXPECT_EQ(websocket::accept_key(std::string(100, 'x')).size(), 28u);
}

TEST(WebSocket, DecodesMessagesByteByByte) {
  Decoder decoder(70000);
  for (const std::size_t size : {0u, 1u, 125u, 126u, 65535u, 65536u}) {
    const std::string text(size, 'm'), bytes = frame(0x81, text);
    for (std::size_t i = 0; i + 1 < bytes.size(); ++i) decoder.append(bytes.substr(i, 1));
    EXPECT_EQ(decoder.next(), Event::none) << size;
    decoder.append(bytes.substr(bytes.size() - 1));
    EXPECT_EQ(decoder.next(), Event::text) << size;
    EXPECT_EQ(decoder.payload(), text);
  }
}

TEST(WebSocket, JoinsFragmentsAroundAPing) {
  Decoder decoder(100);
  decoder.append(frame(0x01, "one ") + frame(0x89, "ping") + frame(0x00, "two ") + frame(0x80, "three"));
  EXPECT_EQ(decoder.next(), Event::ping);
  EXPECT_EQ(decoder.payload(), "ping");
  EXPECT_EQ(decoder.next(), Event::text);
  EXPECT_EQ(decoder.payload(), "one two three");
  EXPECT_EQ(decoder.next(), Event::none);
}

TEST(WebSocket, RejectsViolations) {
  std::string unmasked = websocket::frame_head(Opcode::text, 1) + "x";
  EXPECT_EQ(decode(unmasked), Event::violation);
  EXPECT_EQ(decode(frame(0x80, "continues nothing")), Event::violation);
  EXPECT_EQ(decode(frame(0x01, "a") + frame(0x81, "b")), Event::violation);
  EXPECT_EQ(decode(frame(0xC1, "reserved bit")), Event::violation);
  EXPECT_EQ(decode(frame(0x83, "unknown opcode")), Event::violation);
  EXPECT_EQ(decode(frame(0x09, "fragmented ping")), Event::violation);
  EXPECT_EQ(decode(frame(0x89, std::string(126, 'p'))), Event::violation);
  EXPECT_EQ(decode(frame(0x81, std::string(1001, 'x'))), Event::too_big);
  EXPECT_EQ(decode(frame(0x01, std::string(600, 'x')) + frame(0x80, std::string(600, 'x'))), Event::too_big);
  for (const char* text : {"\xff", "\xc0\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82"})
    EXPECT_EQ(decode(frame(0x81, text)), Event::invalid_text);
  EXPECT_EQ(decode(frame(0x81, "\xe2\x82\xac \xf0\x9f\x8f\x81")), Event::text);
}

TEST(HttpRequest, ParsesHeads) {
  const auto request = parse_request(
      "GET /ws?a=b&token=t HTTP/1.1\r\nHost: a:1\r\nCONNECTION: keep-alive, Upgrade\r\nupgrade:websocket");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->path(), "/ws");
  EXPECT_EQ(request->query("token"), "t");
  EXPECT_EQ(request->query("b"), "");
  EXPECT_EQ(request->field("host"), "a:1");
  EXPECT_TRUE(request->is_upgrade());
  EXPECT_FALSE(parse_request("GET / HTTP/1.1\r\nHost: a")->is_upgrade());
}

TEST(HttpRequest, RejectsMalformedHeads) {
  for (const char* head :
       {"", "GET", "GET / HTTP/2.0", "GET x HTTP/1.1", "G T / HTTP/1.1", "GET / HTTP/1.1\r\nno colon",
        "GET / HTTP/1.1\r\n: empty", "GET / HTTP/1.1\r\nHost: a\r\nhost: b", "GET / HTTP/1.1\r\nA: \x01"})
    EXPECT_FALSE(parse_request(head)) << head;
}

}  // namespace
}  // namespace slalom::view
