// HTTP and WebSocket of the live view's server, through a client that breaks their rules.
#include <gtest/gtest.h>

#include <sys/resource.h>

#include <chrono>
#include <ctime>
#include <deque>
#include <functional>
#include <thread>

#include "view/recording/encodings.hpp"
#include "view/server/page_data.hpp"
#include "view/server/page_policy.hpp"
#include "view/server/server.hpp"
#include "view/web_client.hpp"

namespace slalom::view {
namespace {

using testing::WebClient;

const std::map<std::string, Resource> page = {
    {"/", {"text/html", "gzip", "<p>compressed</p>", "<p>plain</p>"}}};

void wait_until(const std::function<bool()>& holds) {
  for (int i = 0; i < 1000 && !holds(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_TRUE(holds());
}

/// The next message that a server receives; its events are skipped.
std::string next_received(Server& server) {
  for (int i = 0; i < 10; ++i) {
    server.wait(std::chrono::seconds(1));
    for (const Received& each : server.take())
      if (each.kind == Received::Kind::message) return each.text;
  }
  return "nothing came";
}

/// The code with which a server that takes messages of 1000 bytes closes a WebSocket after these frames.
unsigned close_code_after(const std::function<void(WebClient&)>& send) {
  Server server({.max_message = 1000}, page);
  unsigned code = 0;
  {
    WebClient client(server.port());
    client.get("/ws", true);
    wait_until([&] { return server.clients() == 1; });
    send(client);
    code = client.close_code();
  }
  wait_until([&] { return server.clients() == 0; });
  EXPECT_EQ(server.counters().refused_other + server.counters().refused_size, 1u);
  EXPECT_EQ(server.take().size(), 2u) << "joined and left, no message";
  return code;
}

std::string answer_to(Server& server, const std::string& request) {
  WebClient client(server.port());
  client.say(request);
  return client.rest();
}

TEST(ServerProtocol, AcceptsWithTheKeyOfTheRfc) {
  Server server({}, page);
  const std::string head = WebClient(server.port()).get("/ws", true);
  EXPECT_NE(head.find("Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo="), std::string::npos) << head;
}

TEST(ServerProtocol, ReceivesMessagesOfAllSizes) {
  Server server({.max_message = 70000}, page);
  WebClient client(server.port());
  client.get("/ws", true);
  for (const std::size_t size : {0u, 1u, 125u, 126u, 65535u, 65536u}) {
    client.send_message(std::string(size, 'm'));
    EXPECT_EQ(next_received(server), std::string(size, 'm')) << size;
  }
  client.send_message("\xe2\x82\xac \xf0\x9f\x8f\x81");
  EXPECT_EQ(next_received(server), "\xe2\x82\xac \xf0\x9f\x8f\x81");
}

TEST(ServerProtocol, JoinsFragmentsAroundAPing) {
  Server server({}, page);
  WebClient client(server.port());
  client.get("/ws", true);
  client.send_frame(0x01, "one ");
  client.send_frame(0x89, "ping");
  client.send_frame(0x00, "two ");
  client.send_frame(0x80, "three");
  const auto pong = client.next_frame();
  ASSERT_TRUE(pong);
  EXPECT_EQ(pong->opcode, 10u);
  EXPECT_EQ(pong->payload, "ping");
  EXPECT_EQ(next_received(server), "one two three");
}

TEST(ServerProtocol, ClosesOnViolations) {
  constexpr unsigned violation = 1002, invalid_text = 1007, too_big = 1009;
  EXPECT_EQ(close_code_after([](WebClient& c) { c.say("\x81\x01x"); }), violation) << "not masked";
  const auto frame = [](unsigned first, const std::string& payload) {
    return close_code_after([&](WebClient& client) { client.send_frame(first, payload); });
  };
  EXPECT_EQ(frame(0x80, "continues nothing"), violation);
  EXPECT_EQ(frame(0xC1, "reserved bit"), violation);
  EXPECT_EQ(frame(0x83, "unknown opcode"), violation);
  EXPECT_EQ(frame(0x09, "fragmented ping"), violation);
  EXPECT_EQ(frame(0x89, std::string(126, 'p')), violation);
  EXPECT_EQ(frame(0x81, std::string(1001, 'x')), too_big);
  for (const char* text : {"\xff", "\xc0\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82"})
    EXPECT_EQ(frame(0x81, text), invalid_text);
  const auto fragments = [](unsigned second, std::size_t size) {
    return close_code_after([&](WebClient& client) {
      client.send_frame(0x01, std::string(size, 'x'));
      client.send_frame(second, std::string(size, 'x'));
    });
  };
  EXPECT_EQ(fragments(0x81, 1), violation) << "a message within another";
  EXPECT_EQ(fragments(0x80, 600), too_big);
  for (const char* text : {"\xe2\x82", "x\xf0\x90\x80", "\xc3"}) {
    EXPECT_EQ(close_code_after([&](WebClient& client) {
                client.send_frame(0x01, text);
                client.send_frame(0x80, "");
              }),
              invalid_text)
        << "ends within a character, before an empty frame";
  }
}

TEST(ServerProtocol, ServesCompressedPageWithHeaders) {
  Server server({}, page);
  const std::string fields = "Host: localhost\r\nAccept-Encoding: br, gzip;q=0.5\r\n\r\n";
  const std::string whole = answer_to(server, "GET / HTTP/1.1\r\n" + fields);
  for (const char* line :
       {"Content-Type: text/html", "Content-Encoding: gzip", "Content-Length: 17", "Cache-Control: no-store",
        "X-Content-Type-Options: nosniff", "Referrer-Policy: no-referrer",
        "Content-Security-Policy: default-src 'none'; frame-ancestors 'none'\r\n"})
    EXPECT_NE(whole.find(line), std::string::npos) << whole;
  EXPECT_TRUE(whole.ends_with("\r\n\r\n<p>compressed</p>"));
  const std::string head = answer_to(server, "HEAD / HTTP/1.1\r\n" + fields);
  EXPECT_NE(head.find("Content-Length: 17"), std::string::npos) << head;
  EXPECT_TRUE(head.ends_with("\r\n\r\n"));
}

TEST(ServerProtocol, SendsThePolicyThatThePageDeclares) {
  const std::string html = gunzip(page_gzip()), policy = page_policy(html);
  EXPECT_NE(html.find("content=\"" + policy + "\""), std::string::npos);
  EXPECT_NE(policy.find("; script-src 'sha256-"), std::string::npos) << policy;
  const std::string scripts = policy.substr(policy.find("script-src"));
  EXPECT_EQ(scripts.substr(0, scripts.find(';')).find("unsafe"), std::string::npos) << policy;
  for (const std::string& encoded : {std::string(), page_gzip()}) {
    Server server({}, {{"/", page_resource(html, encoded)}});
    const std::string whole =
        answer_to(server, "GET / HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: gzip\r\n\r\n");
    const std::string name = "\r\nContent-Security-Policy: ";
    const std::size_t begin = whole.find(name) + name.size();
    ASSERT_NE(whole.find(name), std::string::npos);
    EXPECT_EQ(whole.substr(begin, whole.find("\r\n", begin) - begin), policy + "; frame-ancestors 'none'");
    EXPECT_EQ(whole.find(name, begin), std::string::npos) << "one policy alone";
  }
  EXPECT_THROW(page_policy("<html><head></head></html>"), std::invalid_argument);
  EXPECT_THROW(page_policy("<head></head><meta http-equiv=\"Content-Security-Policy\" content=\"x\">"),
               std::invalid_argument)
      << "not in the head";
}

TEST(ServerProtocol, CompressesOnlyForThoseWhoAcceptIt) {
  Server server({}, page);
  for (const char* field :
       {"", "Accept-Encoding: br\r\n", "Accept-Encoding: gzip;q=0.0, br\r\n", "Accept-Encoding:\r\n"}) {
    const std::string whole =
        answer_to(server, "GET / HTTP/1.1\r\nHost: localhost\r\n" + std::string(field) + "\r\n");
    EXPECT_EQ(whole.find("Content-Encoding"), std::string::npos) << field;
    EXPECT_NE(whole.find("Vary: Accept-Encoding"), std::string::npos) << field;
    EXPECT_TRUE(whole.ends_with("\r\n\r\n<p>plain</p>")) << field;
  }
}

TEST(ServerProtocol, SlowClientsDoNotKeepOthersOut) {
  Server server({.max_clients = 4}, page);
  std::deque<WebClient> slow;
  for (int i = 0; i < 200; ++i) slow.emplace_back(server.port()).say("GET / HTTP/1.1\r\n");
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_NE(answer_to(server, "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").find(" 200 "), std::string::npos);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5))
      << "a request has 10 s to arrive";
}

TEST(ServerProtocol, WaitsWhileNoFileDescriptorIsLeft) {
  Server server({}, page);
  const int next_descriptor = dup(0);
  close(next_descriptor);
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  const rlimit one_more{static_cast<rlim_t>(next_descriptor) + 1, before.rlim_max};
  setrlimit(RLIMIT_NOFILE, &one_more);
  const std::clock_t processor_time = std::clock();
  WebClient client(server.port());  // has the last descriptor, and the server has none for its side
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_LT(std::clock() - processor_time, CLOCKS_PER_SEC / 4) << "the server must not try without a pause";
  client.say("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_NE(client.rest().find(" 200 "), std::string::npos);
  EXPECT_GE(server.counters().refused_other, 1u);
}

TEST(ServerProtocol, RejectsMalformedRequests) {
  Server server({}, page);
  std::uint64_t refused = 0;
  for (const char* request :
       {"GET\r\n\r\n", "GET / HTTP/2.0\r\n\r\n", "G T / HTTP/1.1\r\n\r\n",
        "GET / HTTP/1.1\r\nno colon\r\n\r\n", "GET / HTTP/1.1\r\n: empty\r\n\r\n",
        "GET / HTTP/1.1\r\nA: \x01\r\n\r\n", "GET / HTTP/1.1\r\nHost: localhost\r\nhost: localhost\r\n\r\n",
        "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\nhello"}) {
    EXPECT_EQ(answer_to(server, request).find(" 200 "), std::string::npos) << request;
    EXPECT_EQ(server.counters().refused_other, ++refused) << request;
  }
  const std::string long_field(9000, 'x');
  EXPECT_EQ(answer_to(server, "GET / HTTP/1.1\r\nA: " + long_field + "\r\n\r\n"), "");
  EXPECT_EQ(server.counters().refused_other, ++refused);
}

}  // namespace
}  // namespace slalom::view
