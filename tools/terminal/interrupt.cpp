#include "tools/terminal/interrupt.hpp"

#include <csignal>

namespace slalom::tools {
namespace {

std::atomic<bool> interrupted{false};
std::atomic<int> caught{0};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may set only lock-free flags");

extern "C" void on_signal(int number) {
  caught = number;
  if (interrupted.exchange(true)) {
    std::signal(number, SIG_DFL);
    std::raise(number);
  }
}

}  // namespace

InterruptFlag::InterruptFlag() {
  interrupted = false;
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

InterruptFlag::~InterruptFlag() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

const std::atomic<bool>& InterruptFlag::raised() const noexcept {
  return interrupted;
}

int exit_status(int status) noexcept {
  constexpr int shell_base = 128;
  return status == 1 && caught != 0 ? shell_base + caught : status;
}

}  // namespace slalom::tools
