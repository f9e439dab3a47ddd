#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

/// The reports and the log of a node.
namespace slalom::nodes {

/// The level of a report, as in diagnostic_msgs/DiagnosticStatus.
enum class Level { ok = 0, warning = 1, error = 2 };

/// The state of a node, about once per second.
struct Report {
  Level level = Level::ok;
  std::string about{};    ///< the subject
  std::string message{};  ///< the state in a few words
  std::vector<std::pair<std::string, std::string>> values{};

  template <class Value>
  void add(const std::string& key, const Value& value) {
    std::ostringstream text;
    text << value;
    values.emplace_back(key, text.str());
  }
};

/// The latest 400 values of a quantity (ten seconds at 40 Hz). Adding one does not allocate.
class RecentValues {
 public:
  void add(double value) {
    values_[next_] = value;
    next_ = (next_ + 1) % values_.size();
    count_ = std::min(count_ + 1, values_.size());
  }
  /// The values in any order.
  std::span<const double> values() const { return std::span(values_).first(count_); }

 private:
  std::array<double, 400> values_{};
  std::size_t count_ = 0, next_ = 0;
};

/// Logs at most one message per second of the steady clock: the last one that came within it.
class ThrottledLog {
 public:
  using Write = std::function<void(const std::string&)>;

  ThrottledLog(std::function<double()> steady, Write write)
      : steady_(std::move(steady)), write_(std::move(write)) {}

  void operator()(const std::string& message) {
    waiting_ = message;
    flush();
  }
  /// Logs the message that waits, if it is due; to be called often.
  void flush() {
    const double now = steady_();
    if (waiting_.empty() || now - last_ < 1) return;
    last_ = now;
    write_(std::exchange(waiting_, {}));
  }

 private:
  std::function<double()> steady_;
  Write write_;
  double last_ = -1e9;
  std::string waiting_;
};

}  // namespace slalom::nodes
