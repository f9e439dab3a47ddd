#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "view/protocol/frame_reader.hpp"
#include "view/session/session.hpp"
#include "view/web_client.hpp"

namespace slalom::view {

using nlohmann::json;

/// A session of any subject with one page, paused at its first step.
class PausedSession {
 public:
  explicit PausedSession(std::unique_ptr<Subject> subject, SessionOptions options = {})
      : session_(std::move(subject), server_, std::move(options)) {
    session_.turn();
    tell({{"do", "pause"}});
  }

  /// Sends commands, which arrive together, and lets the session execute them.
  void say(const std::vector<std::string>& commands) {
    const auto before = server_.counters().messages;
    for (const std::string& command : commands) client_.send_message(command);
    for (int i = 0; i < 5000 && server_.counters().messages < before + commands.size(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    do session_.turn();
    while (session_.is_busy());
  }
  void tell(const json& command) { say({command.dump()}); }
  /// Drives some steps from the one that is shown.
  void step(int steps) { tell({{"do", "step"}, {"ticks", steps}}); }
  /// Lets the drive continue from the step that is shown: what followed is forgotten.
  void continue_here() { say({R"({"do": "play"})", R"({"do": "pause"})"}); }
  /// Drives from the step that is shown up to another; its frame.
  std::string step_to(int tick) {
    continue_here();
    step(tick - last("state")["tick"].get<int>());
    return frame(tick);
  }
  /// A figure of a step; NaN if the step is not known.
  double figure(const std::string& name, int tick) {
    tell({{"do", "past"}, {"from", tick}, {"to", tick}});
    const std::string message = next_binary(Block::past);
    return message.empty() ? none : value(name, FrameReader(message).block(Block::past));
  }
  /// The frame of a step, which is then shown.
  std::string frame(int tick) {
    figure("tick", tick);  // the page has read what came before
    tell({{"do", "seek"}, {"tick", tick}});
    std::string frame;
    do frame = next_binary(Block::scalars);
    while (!frame.empty() && scalar(frame, "tick") != tick);
    return frame;
  }
  /// A figure of a frame.
  double scalar(std::string_view frame, const std::string& name) {
    return value(name, FrameReader(frame).block(Block::scalars));
  }
  /// A figure of the ghost in a step, which is then shown; NaN if there is no ghost.
  double ghost_figure(const std::string& name, int tick) {
    const std::string frame = this->frame(tick);
    const std::string_view ghost = FrameReader(frame).block(Block::ghost_frame);
    return ghost.empty() ? none : scalar(ghost, name);
  }
  /// The last message of a type, while the drive is paused.
  json last(const char* type) {
    tell({{"do", "pause"}});
    figure("tick", 0);
    return last_[type];
  }
  /// The value of an option that the page has.
  std::string option(const std::string& section, const std::string& name) {
    const json options = last("options");
    for (const json& each : options["sections"])
      for (const json& one : each["options"])
        if (each["name"] == section && one["name"] == name) return one["value"];
    return "none";
  }

 protected:
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  /// Reads until a binary message comes that begins with a block.
  std::string next_binary(Block first) {
    for (;;) {
      std::string message = client_.next_message();
      if (message.empty()) return message;
      if (message.starts_with("SLV1")) {
        if (message[4] == static_cast<char>(Block::scalars)) shown_ = message;
        if (message[4] == static_cast<char>(first)) return message;
        continue;
      }
      const json parsed = json::parse(message);
      last_[parsed["type"]] = parsed;
    }
  }
  double value(const std::string& name, std::string_view scalars) {
    const std::vector<std::string> names = last_["hello"]["scalars"];
    const auto i = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    double value = none;
    if (scalars.size() >= 8 * (i + 1)) std::memcpy(&value, &scalars[8 * i], sizeof value);
    return value;
  }

  Server server_{{.messages_per_second = 1e6, .burst = 1e6}, {}};
  testing::PageClient client_{server_};
  Session session_;
  std::map<std::string, json> last_;  ///< the last message of each type
  std::string shown_;                 ///< the last frame
};

}  // namespace slalom::view
