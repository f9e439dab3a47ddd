#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "view/car/car_subject.hpp"
#include "view/recording/drive_files.hpp"
#include "view/web_client.hpp"

/// A session with one client, for the tests of what it does with commands.
namespace slalom::view {

using nlohmann::json;

inline vehicle::Configuration small() {
  vehicle::Configuration configuration;
  for (const char* method : {"svg_mppi", "mppi"})
    for (const auto& [key, value] : {std::pair{"samples", "128"},
                                     {"horizon", "14"},
                                     {"variance", "0.05"},
                                     {"input_min", "-0.4"},
                                     {"input_max", "0.4"},
                                     {"temperature", "3"}})
      vehicle::set_option(configuration, key, value, method);
  vehicle::set_option(configuration, "svg_mppi.batches", "1");
  return configuration;
}

inline std::shared_ptr<const evaluation::Environment> environment_of(const std::string& course) {
  return evaluation::load_environment(SLALOM_COURSES "/" + course, evaluation::Protocol::true_physics, {});
}

inline SessionOptions session_options() {
  SessionOptions options;
  options.scenario = {.course = "stag", .method = "svg_mppi", .config = "default", .seed = 4, .obstacles = 2};
  options.load = [](const ScenarioNames& names) {
    return car_subject(
        {environment_of(names.course), {small(), names.method}, {.obstacles = names.obstacles}}, names.seed);
  };
  add_files(options, {});
  options.choices.courses = {"stag", "eel"};
  options.choices.methods = {"svg_mppi", "mppi"};
  options.choices.configurations = {"default"};
  return options;
}

/// The figures of a frame by name.
inline double scalar(std::string_view frame, const std::string& name) {
  const auto& names = car_scalars();
  const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  double value = 0;
  std::memcpy(&value, frame.data() + 12 + 8 * at, sizeof value);
  return value;
}

/// A session with one client, driven by hand.
class ViewSession : public ::testing::Test {
 protected:
  explicit ViewSession(SessionOptions options = session_options())
      : session_(options.load(options.scenario), server_, options) {}

  void SetUp() override {
    session_.turn();
    tell({{"do", "pause"}});
  }

  /// Sends a command and lets the session handle it.
  void tell(const json& command) { say(command.dump()); }
  void say(const std::string& text) {
    skipped_.clear();
    client_.send_message(text);
    server_.wait(std::chrono::seconds(5));
    do session_.turn();
    while (session_.is_busy());
  }
  /// Reads until a message of JSON of this type comes.
  json next(const std::string& type) { return next(client_, type, &skipped_); }
  static json next(testing::WebClient& client, const std::string& type,
                   std::vector<std::string>* skipped = nullptr) {
    for (;;) {
      std::string message = client.next_message();
      if (message.empty()) return nullptr;
      if (message.rfind("SLV1", 0) == 0) {
        if (skipped) skipped->push_back(std::move(message));
        continue;
      }
      json parsed = json::parse(message);
      if (parsed["type"] == type) return parsed;
    }
  }
  /// Reads until the frame of a tick comes. The server sends frames and JSON in either order, so the frame
  /// may be one that `next` has read since the last command. It must be the newest tick: a client that does
  /// not read fast enough gets only the newest frame. The setup drives tick 0.
  std::string frame(int tick) {
    const auto is_wanted = [&](const std::string& message) {
      return message.rfind("SLV1", 0) == 0 && message[4] == 1 && scalar(message, "tick") == tick;
    };
    const auto found = std::find_if(skipped_.rbegin(), skipped_.rend(), is_wanted);
    if (found != skipped_.rend()) return *found;
    for (;;) {
      std::string message = client_.next_message();
      if (message.empty() || is_wanted(message)) return message;
    }
  }
  /// Drives from the tick that is shown, which becomes the newest one, up to another.
  std::string step_to(int tick) {
    const int shown = last_state_ticks()["tick"];
    tell({{"do", "step"}, {"ticks", tick - shown}});
    return frame(tick);
  }
  json last_state_ticks() {
    tell({{"do", "pause"}});
    json last;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    tell({{"do", "no such command"}});
    for (;;) {
      const std::string message = client_.next_message();
      if (message.rfind("SLV1", 0) == 0) continue;
      const json parsed = json::parse(message);
      if (parsed["type"] == "state") last = parsed;
      if (parsed["type"] == "error") return last;
    }
  }

  Server server_{{.messages_per_second = 1e6, .burst = 1e6}, {}};
  testing::PageClient client_{server_};
  Session session_;
  std::vector<std::string> skipped_;  ///< frames that `next` has read since the last command
};

}  // namespace slalom::view
