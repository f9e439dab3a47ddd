#include <thread>

#include "json/json.hpp"
#include "slalom/view/monitor.hpp"
#include "view/embedded.hpp"
#include "view/session/session.hpp"

namespace slalom::view {
namespace {

ServerOptions server_options(const ServeOptions& given) {
  if (given.token.empty() && !is_loopback(given.host))
    throw std::invalid_argument("token: must be given where other machines can reach host " + given.host);
  return {.host = given.host, .port = given.port, .ports = 10, .token = given.token, .framed_by = notebooks};
}

std::map<std::string, Resource> page() {
  return {{"/", {"text/html; charset=utf-8", page_html(), page_gzip()}}};
}

}  // namespace

void print_address(const std::string& address) {
  std::printf("%s\nopen this address in a browser; Ctrl-C ends\n", address.c_str());
  std::fflush(stdout);
}

struct View::Implementation {
  Implementation(std::unique_ptr<Subject> subject, const ServeOptions& options)
      : server(server_options(options), page()),
        session((subject->restart(), std::move(subject)), server, {.against = options.against}) {
    address = address_of(server, server_options(options));
    if (options.ready) options.ready(address);
  }
  Server server;
  Session session;
  std::string address;
};

View::View(std::unique_ptr<Subject> subject, const ServeOptions& options)
    : implementation_(std::make_unique<Implementation>(std::move(subject), options)) {}
View::~View() = default;

const std::string& View::address() const noexcept {
  return implementation_->address;
}

void View::turn(std::chrono::nanoseconds at_most) {
  implementation_->session.turn(at_most);
}

using Clock = std::chrono::steady_clock;

/// The thread of the page: sends each step that comes, and shows those of the last minute again.
struct MonitorPage::Implementation {
  Implementation(std::unique_ptr<WatchedSource> given, const ServeOptions& options)
      : source(std::move(given)),
        server(server_options(options), page()),
        address(address_of(server, server_options(options))) {
    if (!options.against.empty()) throw std::invalid_argument("against: a monitor shows one controller");
    state.names.method = source->method();
    state.control_period =
        std::max(source->time_step(), std::chrono::duration<double>(min_frame_gap).count());
    timeline = Timeline(state.control_period);
    if (options.ready) options.ready(address);
    thread = std::jthread([this](const std::stop_token& ends) {
      while (!ends.stop_requested()) turn();
    });
  }

  void turn() {
    server.wait(server.clients() > 0 ? min_frame_gap : std::chrono::milliseconds(50));
    audience.turn(
        [this](auto client) { join(client); },
        [this](auto client, const auto& what, const Json& command) { obey(client, what, command); });
    try {
      if (const WatchedStep* step = source->take()) keep(*step);
    } catch (const std::exception& error) {  // the drawing of a user failed
      if (std::exchange(told_error, error.what()) != error.what())
        audience.tell(0, {{"type", "error"}, {"message", told_error}});
    }
    if (server.clients() > 0 && (is_changed || Clock::now() - told > max_state_gap)) tell();
  }

  void keep(const WatchedStep& step) {
    DrivenTick tick{.tick = timeline.newest() + 1};
    const StepMeasures own{.time = step.time,
                           .update_time = step.update_time,
                           .collisions = collisions,
                           .prediction_step = source->time_step()};
    Frame frame = encode_frame(*source, step.solve,
                               {.tick = tick.tick,
                                .measures = source->measures().value_or(own),
                                .period = state.control_period,
                                .state = step.state});
    collisions += frame.collides;
    const Bounds& b = frame.bounds;
    if (tick.tick == 0) state.bounds = b;
    state.bounds.include(b.x0, b.y0);
    state.bounds.include(b.x1, b.y1);
    tick.frame = shared(std::move(frame.message));
    tick.keep_scalars(scalar_names(source->facts()).size());
    timeline.keep(std::move(tick));
    if (!state.paused) server.publish(0, timeline.frame(timeline.newest()));
  }

  void obey(std::uint64_t client, const std::string& what, const Json& command) {
    if (what == "past")
      return server.send(
          client,
          {shared(timeline.past(field::integer(command, "from"), field::integer(command, "to"))), true});
    if (what == "take_over") return audience.take_over(client);
    audience.require_driver(client);
    const int steps = what == "step" ? field::steps(command) : 0;
    if (what == "seek" || what == "step" || what == "pause") {
      state.tick = what == "seek" ? field::integer(command, "tick") : shown() + steps;
      state.paused = true;
    } else if (what == "play") {
      state.paused = false;
    } else {
      throw std::invalid_argument("this page shows a controller that runs elsewhere; it cannot change it");
    }
    is_changed = true;
    if (!timeline.empty()) server.publish(0, timeline.frame(shown()));
  }

  /// The tick that is shown.
  int shown() const {
    return state.paused ? std::clamp(state.tick, timeline.oldest(), timeline.newest()) : timeline.newest();
  }

  void join(std::uint64_t client) {
    audience.tell_text(client, hello_message(source->facts(), {.methods = {state.names.method}},
                                             stored_seconds, state.control_period, {"watch"}));
    if (std::string scene = encode_scene(source->facts()); !scene.empty())
      server.send(client, {shared(std::move(scene)), true});
    OptionsFacts options{.names = state.names, .sections = source->options()};
    audience.tell_text(client, options_message(options));
    is_changed = true;
    if (!timeline.empty()) server.publish(client, timeline.frame(shown()));
  }
  void tell() {
    told = Clock::now();
    is_changed = false;
    DriveState now = state;
    now.tick = shown();
    now.newest = timeline.newest();
    now.oldest = timeline.oldest();
    audience.tell_text(0, state_message(now));
  }

  std::unique_ptr<WatchedSource> source;
  Server server;
  Audience audience{server};
  std::string address, told_error;
  DriveState state;
  Timeline timeline;
  int collisions = 0;
  bool is_changed = true;
  Clock::time_point told = Clock::now();
  const Clock::time_point begin = told;
  Clock::time_point last_step = begin - min_frame_gap;  ///< when the last step came, in the thread that gives
  std::jthread thread;
};

MonitorPage::MonitorPage(std::unique_ptr<WatchedSource> source, const ServeOptions& options)
    : implementation_(std::make_unique<Implementation>(std::move(source), options)) {}
MonitorPage::~MonitorPage() = default;

const std::string& MonitorPage::address() const noexcept {
  return implementation_->address;
}

bool MonitorPage::is_open() const noexcept {
  return implementation_->server.clients() > 0;
}

std::optional<double> MonitorPage::due() noexcept {
  const auto now = Clock::now();
  if (now - implementation_->last_step < min_frame_gap) return {};
  implementation_->last_step = now;
  return std::chrono::duration<double>(now - implementation_->begin).count();
}

}  // namespace slalom::view
