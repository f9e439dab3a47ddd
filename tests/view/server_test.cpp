// The server of the live view: who may come in, what becomes of nonsense, of floods and of clients that never
// read.
#include "view/server/server.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "view/web_client.hpp"

namespace slalom::view {
namespace {

using testing::WebClient;

const std::map<std::string, Resource> page = {{"/", {"text/html", "", "<p>here</p>"}}};

/// Waits until something holds; it fails the test if that takes long.
void until(const std::function<bool()>& holds) {
  for (int i = 0; i < 1000 && !holds(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_TRUE(holds());
}

std::string status(const std::string& head) {
  return head.size() < 12 ? head : head.substr(9, 3);
}

TEST(ViewServer, ServesItsPageAndNothingElse) {
  Server server({}, page);
  EXPECT_EQ(status(WebClient(server.port()).get("/")), "200");
  EXPECT_EQ(status(WebClient(server.port()).get("/?x=1")), "200");
  EXPECT_EQ(status(WebClient(server.port()).get("/etc/passwd")), "404");
  EXPECT_EQ(status(WebClient(server.port()).get("/../")), "404");
  WebClient post(server.port());
  post.say("POST / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(status(post.get("/")), "405");
}

TEST(ViewServer, AcceptsOnlyItsOwnPages) {
  Server server({}, page);
  EXPECT_EQ(status(WebClient(server.port()).get("/ws", true)), "101");
  EXPECT_EQ(status(WebClient(server.port()).get("/ws", true, "localhost:1", "http://localhost:1")), "101");
  EXPECT_EQ(status(WebClient(server.port()).get("/ws", true, "localhost:1", "http://evil.example")), "403");
  EXPECT_EQ(status(WebClient(server.port()).get("/ws", true, "localhost:1", "null")), "403");
  // Somebody else's name may resolve to this machine; the server rejects it.
  EXPECT_EQ(status(WebClient(server.port()).get("/ws", true, "evil.example", "http://evil.example")), "403");
  EXPECT_EQ(status(WebClient(server.port()).get("/", false, "evil.example")), "403");
  EXPECT_EQ(server.counters().refused_origin, 4u);
}

TEST(ViewServer, AsksForItsToken) {
  Server server({.token = "right"}, page);
  EXPECT_EQ(status(WebClient(server.port()).get("/")), "401");
  EXPECT_EQ(status(WebClient(server.port()).get("/?token=wrong")), "401");
  EXPECT_EQ(status(WebClient(server.port()).get("/ws?token=righ", true)), "401");
  EXPECT_EQ(status(WebClient(server.port()).get("/?token=right")), "200");
  EXPECT_EQ(status(WebClient(server.port()).get("/ws?a=b&token=right", true)), "101");
  EXPECT_EQ(server.counters().refused_token, 3u);
}

TEST(ViewServer, RejectsInvalidAddressesAndPorts) {
  EXPECT_THROW(Server({.host = "not an address"}, page), std::invalid_argument);
  Server server({}, page);
  EXPECT_THROW(Server({.port = server.port()}, page), std::runtime_error);
  EXPECT_TRUE(is_loopback("::1"));
  EXPECT_FALSE(is_loopback("0.0.0.0"));
}

TEST(ViewServer, SendsAndReceivesMessages) {
  Server server({}, page);
  WebClient client(server.port());
  client.get("/ws", true);
  until([&] { return server.clients() == 1; });
  const auto joined = server.take();
  ASSERT_EQ(joined.size(), 1u);
  EXPECT_EQ(joined[0].kind, Received::Kind::joined);
  server.send(joined[0].client, {std::make_shared<const std::string>("one"), false});
  server.broadcast({std::make_shared<const std::string>(300000, 'x'), true});
  server.publish(std::make_shared<const std::string>("frame"));
  EXPECT_EQ(client.next_message(), "one");
  EXPECT_EQ(client.next_message(), std::string(300000, 'x'));
  EXPECT_EQ(client.next_message(), "frame");
  client.send_message("hello");
  server.wait(std::chrono::seconds(5));
  const auto got = server.take();
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0].text, "hello");
}

/// As the recording of a minute is; the messages around it arrive, too.
TEST(ViewServer, SendsAFileThatIsLargerThanWhatMayWait) {
  Server server({}, page);
  WebClient client(server.port());
  client.get("/ws", true);
  until([&] { return server.clients() == 1; });
  const std::uint64_t number = server.take().at(0).client;
  const auto file = std::make_shared<const std::string>(std::size_t{100} << 20, 'x');
  server.send(number, {std::make_shared<const std::string>("before"), false});
  server.send(number, {file, true});
  EXPECT_EQ(client.next_message(), "before");
  EXPECT_TRUE(client.next_message() == *file);
  server.send(number, {std::make_shared<const std::string>("after"), false});
  EXPECT_EQ(client.next_message(), "after");
  EXPECT_EQ(server.clients(), 1);
}

TEST(ViewServer, SurvivesTenThousandInvalidMessages) {
  Server server({.max_message = 1000, .messages_per_second = 100, .burst = 100}, page);
  // Each client sends 400 messages that are not commands, and ends with bytes that are not a message.
  for (int client = 0; client < 25; ++client) {
    WebClient talker(server.port());
    talker.get("/ws", true);
    for (int i = 0; i < 400; ++i) talker.send_message(i % 4 == 0 ? "\x01\x02" : "}{", i % 4 == 0 ? 2 : 1);
    if (client % 2 == 1) {
      talker.say(std::string("\xff\xff\xff\xff\xff\xff", 6));
      continue;
    }
    talker.send_message(std::string(5000, 'y'));
    while (!talker.next_message().empty()) {
    }
  }
  WebClient raw(server.port());
  raw.say(std::string(20000, 'z'));
  const ServerCounters counters = server.counters();
  EXPECT_GT(counters.refused_size, 0u);
  EXPECT_GT(counters.refused_other, 0u);
  EXPECT_GT(counters.refused_rate, 0u);
  EXPECT_LE(server.take().size(), 2000u) << "what is kept is bounded";
  EXPECT_EQ(status(WebClient(server.port()).get("/")), "200");
  WebClient good(server.port());
  EXPECT_EQ(status(good.get("/ws", true)), "101");
  server.wait(std::chrono::seconds(1));
  server.publish(std::make_shared<const std::string>("alive"));
}

TEST(ViewServer, AClientThatNeverReadsLosesFramesAndDelaysNobody) {
  Server server({}, page);
  WebClient asleep(server.port(), 4096), awake(server.port());
  asleep.get("/ws", true);
  awake.get("/ws", true);
  until([&] { return server.clients() == 2; });
  const int frames = 200;
  for (int i = 0; i < frames; ++i) {
    auto frame = std::string(200000, 'f');
    frame += std::to_string(i);
    server.publish(std::make_shared<const std::string>(std::move(frame)));
    EXPECT_GE(awake.next_message().size(), 200001u) << i;
  }
  EXPECT_GT(server.counters().frames_dropped, static_cast<std::uint64_t>(frames / 2));
  EXPECT_EQ(server.clients(), 2);
}

/// Acknowledges the frames shown so far.
void acknowledge(WebClient& client, unsigned frames) {
  const char count[4] = {static_cast<char>(frames & 255u), static_cast<char>(frames >> 8u)};
  client.send_message({count, sizeof count}, 2);
}

TEST(ViewServer, SendsTwoFramesUntilOneIsAcknowledgedAndMessagesOvertakeTheRest) {
  Server server({}, page);
  WebClient client(server.port());
  client.get("/ws?acknowledge=1", true);
  until([&] { return server.clients() == 1; });
  const auto publish = [&](const char* frame, std::uint64_t dropped) {
    server.publish(std::make_shared<const std::string>(frame));
    // The server's thread has this frame once the message after it has arrived.
    server.broadcast({std::make_shared<const std::string>("message"), false});
    while (client.next_message() != "message") {
    }
    EXPECT_EQ(server.counters().frames_dropped, dropped) << frame;
  };
  server.publish(std::make_shared<const std::string>("first"));
  EXPECT_EQ(client.next_message(), "first");
  server.publish(std::make_shared<const std::string>("second"));
  EXPECT_EQ(client.next_message(), "second");
  publish("third", 0);
  publish("fourth", 1);
  publish("fifth", 2);
  EXPECT_EQ(server.counters().frames_sent, 2u);

  acknowledge(client, 1);
  EXPECT_EQ(client.next_message(), "fifth") << "the newest frame, without those between";
  EXPECT_EQ(server.counters().refused_other, 0u);
}

TEST(ViewServer, AFrameForOneClientCanBeAcknowledged) {
  Server server({}, page);
  WebClient client(server.port());
  client.get("/ws?acknowledge=1", true);
  until([&] { return server.clients() == 1; });
  server.publish(server.take().at(0).client, std::make_shared<const std::string>("greeting"));
  EXPECT_EQ(client.next_message(), "greeting");
  acknowledge(client, 1);
  client.send_message("after the acknowledgement");
  until([&] { return server.counters().messages == 1; });
  EXPECT_EQ(server.counters().refused_other, 0u);
}

TEST(ViewServer, RefusesImpossibleAcknowledgements) {
  Server server({}, page);
  WebClient client(server.port()), other(server.port());
  client.get("/ws?acknowledge=1", true);
  other.get("/ws", true);
  until([&] { return server.clients() == 2; });
  acknowledge(client, 1);  // nothing has been sent
  server.publish(std::make_shared<const std::string>("frame"));
  EXPECT_EQ(client.next_message(), "frame");
  EXPECT_EQ(other.next_message(), "frame");
  acknowledge(client, 1);
  acknowledge(client, 1);           // not new
  client.send_message("12345", 2);  // not a number of frames
  acknowledge(other, 1);            // this client did not say that it acknowledges
  until([&] { return server.counters().refused_other == 4; });
}

TEST(ViewServer, RejectsClientsAboveItsLimit) {
  Server server({.max_clients = 2}, page);
  WebClient a(server.port()), b(server.port());
  a.get("/ws", true);
  b.get("/ws", true);
  until([&] { return server.clients() == 2; });
  EXPECT_EQ(status(WebClient(server.port()).get("/ws", true)), "503");
}

}  // namespace
}  // namespace slalom::view
