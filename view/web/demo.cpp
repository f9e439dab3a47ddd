// The demonstration that runs in a browser from static files: the session of a problem in a Web Worker, whose
// page gets its messages with postMessage instead of a WebSocket.
#include <emscripten.h>

#include "slalom/solvers/svg_mppi_options.hpp"
#include "view/problem/differential_drive.hpp"
#include "view/server/server.hpp"
#include "view/session/session.hpp"

namespace {

std::vector<slalom::view::Received> received;
std::uint32_t sent = 0, acknowledged = 0;  // frames

// clang-format off
EM_JS(void, post, (const char* data, std::size_t size, bool is_binary), {
  if (!is_binary) return postMessage(UTF8ToString(data, size));
  const copy = HEAPU8.slice(data, data + size).buffer;
  postMessage(copy, [copy]);
});
// clang-format on

}  // namespace

namespace slalom::view {

/// A server of one page, which is in the same browser. All messages go through the worker's own queue.
struct Server::Implementation {
  std::shared_ptr<const std::string> frame;  ///< the newest one, until it is sent
};

Server::Server(const ServerOptions&, std::map<std::string, Resource>)
    : implementation_(std::make_unique<Implementation>()) {}
Server::~Server() = default;

void Server::publish(std::uint64_t, std::shared_ptr<const std::string> frame) {
  implementation_->frame = std::move(frame);
}

void Server::send(std::uint64_t, Message message) {
  post(message.body->data(), message.body->size(), message.binary);
}

std::vector<Received> Server::take() {
  return std::exchange(received, {});
}

/// Sends the newest frame if the page has drawn those before it, but for one.
void Server::wait(std::chrono::nanoseconds) {
  constexpr std::uint32_t most_under_way = 2;
  if (!implementation_->frame || sent - acknowledged >= most_under_way) return;
  ++sent;
  send(0, {std::exchange(implementation_->frame, nullptr), true});
}

int Server::clients() const noexcept {
  return 1;
}

}  // namespace slalom::view

namespace {

/// A robot among discs. Once it is at its goal, it begins again.
std::unique_ptr<slalom::view::Subject> robot() {
  using slalom::problems::DifferentialDrive;
  using State = DifferentialDrive::State<double>;
  auto drawing = slalom::view::drawing_among_discs();
  drawing.title = "a robot among discs";
  drawing.plant = [](const State& x, const slalom::Input<double, 2>& u) {
    const DifferentialDrive problem;
    return problem.distance(x) < 0.5 ? State{} : problem.step(x, u);
  };
  const slalom::SvgMppiOptions options{.horizon = 25, .input_min = {0, -2}, .input_max = {1.5, 2}};
  return std::make_unique<slalom::view::detail::ControllerSubject<DifferentialDrive>>(
      slalom::Controller<DifferentialDrive>({}, options), std::move(drawing));
}

struct Demonstration {
  slalom::view::Server server{{}, {}};
  slalom::view::Session session{robot(), server};
};

}  // namespace

extern "C" {

/// Takes a command of the page, or with null the page itself.
EMSCRIPTEN_KEEPALIVE void take(const char* command) {
  using Kind = slalom::view::Received::Kind;
  received.push_back({command ? Kind::message : Kind::joined, 1, command ? command : ""});
}

/// Notes how many frames the page has drawn.
EMSCRIPTEN_KEEPALIVE void acknowledge(std::uint32_t frames) {
  acknowledged = frames;
}

/// Executes commands and drives the step that is due.
EMSCRIPTEN_KEEPALIVE void turn() {
  static Demonstration demonstration;
  demonstration.session.turn(std::chrono::nanoseconds(0));
  demonstration.server.wait({});
}
}
