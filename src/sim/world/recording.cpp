#include "slalom/sim/recording.hpp"

#include <charconv>
#include <span>
#include <stdexcept>

namespace slalom::sim {
namespace {

constexpr std::string_view heading = "slalom recording 1";

void write(std::string& text, double value) {
  char digits[32];
  // The shortest form that reads back to the same bits.
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text.append(1, ' ').append(digits, end);
}

/// Lines of words, one after the other.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  bool next_line() {
    if (text_.empty()) return false;
    ++number_;
    const std::size_t end = text_.find('\n');
    line_ = text_.substr(0, end);
    text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
    return true;
  }
  std::string_view line() const { return line_; }
  std::string_view word() {
    line_.remove_prefix(std::min(line_.find_first_not_of(' '), line_.size()));
    const std::string_view found = line_.substr(0, line_.find(' '));
    line_.remove_prefix(found.size());
    return found;
  }
  bool at_end() const { return line_.find_first_not_of(' ') == std::string_view::npos; }
  template <class T>
  T number(const char* what) {
    const std::string_view digits = word();
    T value{};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size() || digits.empty())
      fail(std::string("expected ") + what + ", found '" + std::string(digits) + "'");
    return value;
  }
  [[noreturn]] void fail(const std::string& why) const {
    throw std::invalid_argument("recording, line " + std::to_string(number_) + ": " + why);
  }

 private:
  std::string_view text_, line_;
  int number_ = 0;
};

}  // namespace

void Recording::begin(World& world) {
  commands.clear();
  world.reset(seed, cars, parked);
}

StepStatus Recording::step(World& world, std::span<const Command> step_commands) {
  if (step_commands.size() != cars.size())
    throw std::invalid_argument("recorded commands = " + std::to_string(step_commands.size()) +
                                ": must be one per driven car, " + std::to_string(cars.size()));
  commands.insert(commands.end(), step_commands.begin(), step_commands.end());
  return world.step(step_commands);
}

void Recording::replay(World& world) const {
  world.reset(seed, cars, parked);
  if (cars.empty()) return;
  for (std::size_t first = 0; first + cars.size() <= commands.size(); first += cars.size())
    world.step(std::span(commands).subspan(first, cars.size()));
}

std::string Recording::to_text() const {
  std::string text(heading);
  text += "\nseed " + std::to_string(seed) + "\n";
  const auto poses = [&](const char* name, const std::vector<maps::Pose>& list) {
    for (const maps::Pose& pose : list) {
      text += name;
      write(text, pose.x);
      write(text, pose.y);
      write(text, pose.yaw);
      text += '\n';
    }
  };
  poses("car", cars);
  poses("parked", parked);
  const std::size_t steps = cars.empty() ? 0 : commands.size() / cars.size();
  for (std::size_t step = 0; step < steps; ++step) {
    text += "step";
    for (const Command& command : std::span(commands).subspan(step * cars.size(), cars.size())) {
      write(text, command.steer);
      write(text, command.speed);
    }
    text += '\n';
  }
  return text;
}

Recording Recording::from_text(std::string_view text) {
  Reader reader(text);
  if (!reader.next_line() || reader.line() != heading)
    throw std::invalid_argument("recording, line 1: must be '" + std::string(heading) + "'");
  Recording recording;
  while (reader.next_line()) {
    const std::string_view what = reader.word();
    if (what == "seed") {
      recording.seed = reader.number<std::uint64_t>("a whole number");
    } else if (what == "car" || what == "parked") {
      const double x = reader.number<double>("x"), y = reader.number<double>("y");
      (what == "car" ? recording.cars : recording.parked).push_back({x, y, reader.number<double>("yaw")});
    } else if (what == "step") {
      for (std::size_t i = 0; i < recording.cars.size(); ++i) {
        const double steering = reader.number<double>("a steering command");
        recording.commands.push_back({steering, reader.number<double>("a drive command")});
      }
    } else {
      reader.fail("unknown word '" + std::string(what) + "'");
    }
    if (!reader.at_end()) reader.fail("unexpected text at the end of the line");
  }
  return recording;
}

}  // namespace slalom::sim
