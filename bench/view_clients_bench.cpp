// Whether clients of the live view slow the controller: the planner's time per control step with one client
// that measures, and with five more that read and one that never reads, measured alternately.
//
//     slalom_view_clients_bench COURSE_FOLDER [ROUNDS]
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "view/protocol/frame.hpp"
#include "view/session/session.hpp"
#include "view/web_client.hpp"

namespace {

using namespace slalom;
using testing::WebClient;

constexpr double rate = 2;  // simulated / real time; every frame can still be sent
constexpr int ticks_per_turn = 300, ticks_to_settle = 20;
constexpr int readers = 5;

view::SessionOptions scenario(const std::string& course) {
  view::SessionOptions options;
  options.scenario = {.course = course, .seed = 1, .obstacles = 5};
  options.load = [](const view::ScenarioNames& names) {
    return view::LoadedScenario{
        evaluation::load_environment(names.course, evaluation::Protocol::true_physics, {}),
        vehicle::Configuration{},
        {.obstacles = names.obstacles}};
  };
  options.choices.methods = {"svg_mppi"};
  return options;
}

std::size_t index_of(const char* name) {
  const auto names = view::scalar_names();
  return static_cast<std::size_t>(
      std::find_if(names.begin(), names.end(), [&](const char* each) { return !std::strcmp(each, name); }) -
      names.begin());
}

/// The planner's time of a frame, ms; negative for other messages.
double tick_time(const std::string& message) {
  static const std::size_t at = 12 + 8 * index_of("tick_ms");
  double value = -1;
  if (message.rfind("SLV1", 0) == 0 && message.size() > at + 8 && message[4] == 1)
    std::memcpy(&value, message.data() + at, sizeof value);
  return value;
}

/// Clients that are connected while the object lives.
class Crowd {
 public:
  explicit Crowd(std::uint16_t port) : asleep_(port, 4096) {
    asleep_.get("/ws", true);
    for (int i = 0; i < readers; ++i) {
      clients_.push_back(std::make_unique<WebClient>(port));
      clients_.back()->get("/ws", true);
      threads_.emplace_back([this, &client = *clients_.back()] {
        while (!leave_ && !client.next_message().empty()) {
        }
      });
    }
  }
  ~Crowd() {
    leave_ = true;
    for (auto& thread : threads_) thread.join();
  }

 private:
  WebClient asleep_;
  std::vector<std::unique_ptr<WebClient>> clients_;
  std::vector<std::thread> threads_;
  std::atomic<bool> leave_{false};
};

void measure(WebClient& client, std::vector<double>& into) {
  for (int i = 0; i < ticks_to_settle + ticks_per_turn;) {
    const double time = tick_time(client.next_message());
    if (time < 0) continue;
    if (++i > ticks_to_settle) into.push_back(time);
  }
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: slalom_view_clients_bench COURSE_FOLDER [ROUNDS]\n");
    return 2;
  }
  const int rounds = argc > 2 ? static_cast<int>(std::strtol(argv[2], nullptr, 10)) : 20;
  view::Server server({}, {});
  view::Session session(scenario(argv[1]), server);
  std::atomic<bool> stop{false};
  std::thread driver([&] { session.run(stop); });
  WebClient client(server.port());
  client.get("/ws", true);
  client.send_message("{\"do\":\"rate\",\"rate\":" + std::to_string(rate) + "}");
  std::vector<double> alone, crowded;
  for (int i = 0; i < rounds; ++i) {
    measure(client, alone);
    const Crowd crowd(server.port());
    measure(client, crowded);
  }
  stop = true;
  driver.join();
  std::printf("%-34s %8s %10s %10s\n", "planner update, ms", "ticks", "p50", "p99");
  std::printf("%-34s %8zu %10.4f %10.4f\n", "one client", alone.size(), quantile(alone, 0.5),
              quantile(alone, 0.99));
  std::printf("%-34s %8zu %10.4f %10.4f\n", "and five, and one that never reads", crowded.size(),
              quantile(crowded, 0.5), quantile(crowded, 0.99));
  const auto counters = server.counters();
  std::printf("p99 changes by %+.1f %%; %llu frames sent, %llu dropped\n",
              100 * (quantile(crowded, 0.99) / quantile(alone, 0.99) - 1),
              static_cast<unsigned long long>(counters.frames_sent),
              static_cast<unsigned long long>(counters.frames_dropped));
  return 0;
}
