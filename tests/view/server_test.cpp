// The server of the live view: access, broken and excessive messages, clients that never read.
#include "view/server/server.hpp"

#include <gtest/gtest.h>

#include "view/web_client.hpp"

namespace slalom::view {
namespace {

using namespace testing;

const std::map<std::string, Resource> page = {{"/", {"text/html", "<p>here</p>"}}};

/// The status of the answer to a GET.
std::string get(const Server& server, const std::string& target, bool upgrade = false,
                const std::string& host = "127.0.0.1", const std::string& origin = "") {
  const std::string head = WebClient(server.port()).get(target, upgrade, host, origin);
  return head.size() < 12 ? head : head.substr(9, 3);
}

std::string answer_to(const Server& server, const std::string& request) {
  WebClient client(server.port());
  client.say(request);
  return client.rest();
}

/// The next message that a server receives.
std::string next_received(Server& server) {
  for (int i = 0; i < 10; ++i) {
    server.wait(std::chrono::seconds(1));
    for (const Received& each : server.take())
      if (each.kind == Received::Kind::message) return each.text;
  }
  return "nothing came";
}

Message message(const std::string& text) {
  return {std::make_shared<const std::string>(text), false};
}

TEST(ViewServer, ServesItsPageAndNothingElse) {
  const Server server({}, page);
  EXPECT_EQ(get(server, "/"), "200");
  EXPECT_EQ(get(server, "/?x=1"), "200");
  EXPECT_EQ(get(server, "/etc/passwd"), "404");
  EXPECT_EQ(get(server, "/../"), "404");
  EXPECT_NE(answer_to(server, "POST / HTTP/1.1\r\nHost: localhost\r\n\r\n").find(" 405 "), std::string::npos);
}

TEST(ViewServer, TakesTheNextPortWhereOneIsTaken) {
  const Server first({}, page);
  const Server second({.port = first.port(), .ports = 10}, page);
  EXPECT_GT(second.port(), first.port());
  EXPECT_LT(second.port(), first.port() + 10);
  EXPECT_THROW(Server({.port = first.port()}, page), std::runtime_error);
  EXPECT_THROW(Server({.host = "not an address"}, page), std::invalid_argument);
  EXPECT_TRUE(is_loopback("::1"));
  EXPECT_FALSE(is_loopback("0.0.0.0"));
}

TEST(ViewServer, MakesAResourceAtItsFirstRequest) {
  int made = 0;
  std::string content;
  const auto make = [&]() -> const std::string& { return content = "<p>" + std::to_string(++made) + "</p>"; };
  const Server server({}, {{"/", {.type = "text/html", .body = {}, .later = make}}});
  EXPECT_EQ(made, 0);
  EXPECT_TRUE(answer_to(server, "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").ends_with("<p>1</p>"));
}

TEST(ViewServer, ServesItsPageCompressedOrPlainWithHeaders) {
  const Server server({}, {{"/", {"text/html", "<p>here</p>", "compressed"}}});
  for (const auto& [accepted, packed] : {std::pair("Accept-Encoding: gzip\r\n", true),
                                         {"Accept-Encoding: br, GZip;q=0.5, identity\r\n", true},
                                         {"Accept-Encoding: identity\r\n", false},
                                         {"Accept-Encoding: gzip;q=0.0, *\r\n", false},
                                         {"", false}}) {
    const std::string whole =
        answer_to(server, std::string("GET / HTTP/1.1\r\nHost: localhost\r\n") + accepted + "\r\n");
    for (const char* line :
         {"Content-Type: text/html", "Cache-Control: no-store", "X-Content-Type-Options: nosniff",
          "Content-Security-Policy: frame-ancestors 'none'\r\n"})
      EXPECT_NE(whole.find(line), std::string::npos) << whole;
    EXPECT_EQ(whole.find("Content-Encoding: gzip") != std::string::npos, packed) << whole;
    EXPECT_TRUE(whole.ends_with(packed ? "Length: 10\r\n\r\ncompressed" : "Length: 11\r\n\r\n<p>here</p>"))
        << whole;
  }
  const Server framed({.framed_by = "http://localhost:*"}, page);
  EXPECT_NE(answer_to(framed, "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
                .find("frame-ancestors http://localhost:*"),
            std::string::npos);
  const std::string head = answer_to(server, "HEAD / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_TRUE(head.ends_with("\r\n\r\n")) << head;
}

TEST(ViewServer, AcceptsOnlyItsOwnPages) {
  const Server server({}, page);
  EXPECT_EQ(get(server, "/ws", true), "101");
  EXPECT_EQ(get(server, "/ws", true, "localhost:1", "http://localhost:1"), "101");
  EXPECT_EQ(get(server, "/ws", true, "localhost:1", "http://evil.example"), "403");
  EXPECT_EQ(get(server, "/ws", true, "localhost:1", "null"), "403");
  // The name of another site may resolve to this machine; the server rejects it.
  EXPECT_EQ(get(server, "/ws", true, "evil.example", "http://evil.example"), "403");
  EXPECT_EQ(get(server, "/", false, "evil.example"), "403");
  EXPECT_EQ(server.counters().refused, 4u);
}

TEST(ViewServer, AsksForItsToken) {
  const Server server({.token = "right"}, page);
  EXPECT_EQ(get(server, "/"), "401");
  EXPECT_EQ(get(server, "/?token=wrong"), "401");
  EXPECT_EQ(get(server, "/ws?token=righ", true), "401");
  EXPECT_EQ(get(server, "/?token=right"), "200");
  EXPECT_EQ(get(server, "/ws?a=b&token=right", true), "101");
}

TEST(ViewServer, RejectsMalformedRequests) {
  const Server server({}, page);
  std::uint64_t refused = 0;
  for (const char* request : {"GET\r\n\r\n", "G T / HTTP/1.1\r\n\r\n", "GET / HTTP/1.1\r\nno colon\r\n\r\n",
                              "GET / HTTP/1.1\r\nHost: localhost\r\nhost: localhost\r\n\r\n"}) {
    EXPECT_EQ(answer_to(server, request).find(" 200 "), std::string::npos) << request;
    EXPECT_EQ(server.counters().refused, ++refused) << request;
  }
  EXPECT_EQ(answer_to(server, "GET / HTTP/1.1\r\nA: " + std::string(9000, 'x') + "\r\n\r\n"), "");
}

TEST(ViewServer, SendsAndReceivesMessages) {
  Server server({}, page);
  PageClient client(server);
  const auto joined = server.take();
  ASSERT_EQ(joined.size(), 1u);
  EXPECT_EQ(joined[0].kind, Received::Kind::joined);
  server.send(joined[0].client, message("one"));
  const auto file = std::make_shared<const std::string>(std::size_t{100} << 20, 'x');  // more than may wait
  server.send(0, {file, true});
  server.publish(0, std::make_shared<const std::string>("frame"));
  EXPECT_EQ(client.next_message(), "one");
  EXPECT_TRUE(client.next_message() == *file);
  EXPECT_EQ(client.next_message(), "frame");
  client.send_message("hello");
  EXPECT_EQ(next_received(server), "hello");
  client.send_frame(0x01, "in ");
  client.send_frame(0x80, "two");
  EXPECT_EQ(next_received(server), "in two");
}

TEST(ViewServer, SurvivesFloodsOfInvalidMessages) {
  Server server({.max_message = 1000, .messages_per_second = 100, .burst = 100}, page);
  for (int client = 0; client < 5; ++client) {
    PageClient talker(server);
    for (int i = 0; i < 400; ++i) talker.send_message(i % 4 == 0 ? "\x01\x02" : "}{", i % 4 == 0 ? 2 : 1);
    talker.send_message(std::string(5000, 'y'));
    while (!talker.next_message().empty()) {
    }
  }
  EXPECT_GT(server.counters().refused, 1000u);
  EXPECT_LE(server.counters().messages, 5u * 110u);
  EXPECT_EQ(get(server, "/"), "200");
}

TEST(ViewServer, AClientThatNeverReadsLosesFramesAndDelaysNobody) {
  Server server({.max_clients = 2}, page);
  PageClient asleep(server, 1, "/ws", 4096), awake(server, 2);
  constexpr int frames = 100;
  for (int i = 0; i < frames; ++i) {
    server.publish(0, std::make_shared<const std::string>(200000, 'f'));
    EXPECT_EQ(awake.next_message().size(), 200000u) << i;
  }
  EXPECT_GT(server.counters().frames_dropped, frames / 2u);
  EXPECT_EQ(server.clients(), 2);
  EXPECT_EQ(get(server, "/ws", true), "503") << "a third one";
}

/// Acknowledges the frames shown so far.
void acknowledge(WebClient& client, unsigned frames) {
  const char count[4] = {static_cast<char>(frames & 255u), static_cast<char>(frames >> 8u)};
  client.send_message({count, sizeof count}, 2);
}

TEST(ViewServer, SendsTwoFramesUntilOneIsAcknowledgedAndMessagesOvertakeTheRest) {
  Server server({}, page);
  PageClient client(server, 1, "/ws?acknowledge=1");
  acknowledge(client, 1);  // nothing has been sent: refused
  for (int i = 0; i < 1000 && server.counters().refused == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  for (const char* frame : {"first", "second"}) {
    server.publish(0, std::make_shared<const std::string>(frame));
    EXPECT_EQ(client.next_message(), frame);
  }
  for (const char* frame : {"third", "fourth", "fifth"}) {
    server.publish(0, std::make_shared<const std::string>(frame));
    // The server's thread has this frame once the message after it has arrived.
    server.send(0, message("message"));
    EXPECT_EQ(client.next_message(), "message");
  }
  EXPECT_EQ(server.counters().frames_dropped, 2u);
  acknowledge(client, 1);
  EXPECT_EQ(client.next_message(), "fifth") << "the newest frame, without those between";
  EXPECT_EQ(server.counters().refused, 1u);
}

}  // namespace
}  // namespace slalom::view
