#pragma once

#include <functional>
#include <string>
#include <utility>

namespace slalom_bridge {

/// Logs at most one message per second of the steady clock. Of the messages that come sooner the last is
/// logged when the second is over.
class ThrottledLog {
 public:
  using Write = std::function<void(const std::string&)>;

  ThrottledLog(std::function<double()> steady, Write write)
      : steady_(std::move(steady)), write_(std::move(write)) {}

  void operator()(const std::string& message) {
    waiting_ = message;
    flush();
  }
  /// To be called often.
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

}  // namespace slalom_bridge
