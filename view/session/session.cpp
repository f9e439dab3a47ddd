#include "view/session/session.hpp"

#include <algorithm>
#include <random>
#include <utility>

#include "src/evaluation/json.hpp"

namespace slalom::view {
namespace {

constexpr std::size_t max_history_bytes = 400u << 20;
constexpr auto min_frame_gap = std::chrono::milliseconds(12);  // no screen shows more
constexpr auto state_gap = std::chrono::milliseconds(250);
constexpr int max_late_ticks = 4;  // ticks that a late clock may owe

}  // namespace

Session::Session(SessionOptions options, Server& server)
    : options_(std::move(options)), server_(server), waiting_(options_.wait_for_client) {
  load(options_.scenario);
  std::random_device random;
  number_ = std::to_string(random()) + "-" + std::to_string(random());
  if (!options_.against.empty()) start_ghost(options_.against, configuration_);
  introduces_ = options_.introduction;
  slow_down();
}

Session::~Session() = default;

void Session::load(const ScenarioNames& names) {
  install(options_.load(names), names);
}

void Session::install(LoadedScenario loaded, const ScenarioNames& names) {
  // All that may throw comes before anything is replaced.
  Simulation simulation({loaded.environment, {loaded.configuration, names.method}, loaded.lap}, names.seed);
  const auto scene = std::make_shared<const std::string>(encode_scene(*loaded.environment));
  scenario_ = std::move(loaded);
  configuration_ = scenario_.configuration;
  undo_.clear();
  names_ = names;
  scene_ = scene;
  server_.broadcast({scene_, true});
  begin_drive(std::move(simulation), {});
  tell_options();
}

/// Restarts the drive with the same seed, and the ghost with it.
void Session::restart() {
  // All that may throw comes before anything is replaced.
  Simulation simulation(make_setup(configuration_, names_.method), names_.seed);
  std::optional<Simulation> ghost;
  if (ghost_) {
    const evaluation::Driver& driver = ghost_->loop().setup().driver;
    const auto setup = make_setup(driver.configuration, driver.method);
    if (setup.control_period() == simulation.loop().setup().control_period())
      ghost.emplace(setup, names_.seed);
  }
  begin_drive(std::move(simulation), std::move(ghost));
}

/// Drives these from now on; without a ghost the present one ends.
void Session::begin_drive(Simulation simulation, std::optional<Simulation> ghost) {
  simulation_ = std::move(simulation);
  if (ghost)
    ghost_ = std::move(ghost);
  else
    end_ghost();
  history_.clear();
  history_bytes_ = 0;
  laps_.clear();
  undo_.forget_bodies();
  viewed_ = stop_at_ = -1;
  steps_left_ = 0;
  contact_.fill(-1);
  slow_motion_ = {};
  slow_down();
  for (Redrive& each : redrives_) each.begin_anew();
  ++generation_;
  due_ = Clock::now();
  state_changed_ = true;
}

evaluation::LapSetup Session::make_setup(const vehicle::Configuration& configuration,
                                         const std::string& method) const {
  return {scenario_.environment, {configuration, method}, scenario_.lap};
}

void Session::run(const std::atomic<bool>& stop) {
  while (!stop) {
    const auto wait = is_busy() ? Clock::duration::zero()
                                : std::min<Clock::duration>(until_due(), std::chrono::milliseconds(50));
    if (wait > Clock::duration::zero()) server_.wait(wait);
    turn();
  }
}

void Session::turn() {
  handle_all();
  drive_again();
  if (until_due() <= Clock::duration::zero()) {
    if (steps_left_ > 0) --steps_left_;
    tick();
  }
  const auto now = Clock::now();
  if (server_.clients() > 0 && (state_changed_ || now - last_state_ > 4 * state_gap)) {
    last_state_ = now;
    tell_state();
  }
}

Session::Clock::duration Session::until_due() const {
  if (steps_left_ > 0) return Clock::duration::zero();
  if (waiting_ || paused_) return std::chrono::hours(1);
  if (rate_ <= 0) return Clock::duration::zero();
  return due_ - Clock::now();
}

void Session::tick() {
  const auto now = Clock::now();
  const auto period = std::chrono::duration<double>(simulation_->loop().setup().control_period());
  if (rate_ > 0) {
    const auto step = std::chrono::duration_cast<Clock::duration>(period / rate_);
    due_ = std::max(due_ + step, now - max_late_ticks * step);
  }
  Step made;
  std::string ghost, ghost_bodies;
  if (ghost_) {
    ghost_->tick(
        [&](const evaluation::ControlStep& step) {
          std::vector<maps::Pose> plan;
          for (const auto& state : step.output.predicted) plan.push_back(state.pose);
          ghost = encode_ghost(step.world, plan);
          made.ghost = encoder_.encode(step, facts_of(ghost_->loop().setup()));
          ghost_bodies = encode_bodies(step.world);
        },
        real_time_);
  }
  simulation_->tick(
      [&](const evaluation::ControlStep& step) {
        made.tick = step.step;
        made.without_bodies = encoder_.encode(step, facts_of(simulation_->loop().setup())) + ghost;
        made.frame = frame_of(made, encode_bodies(step.world), ghost_bodies);
      },
      real_time_);
  keep(std::move(made));
  note_laps();
  slow_down();
  if (history_.back().tick == stop_at_) {
    paused_ = true;
    stop_at_ = -1;
    state_changed_ = true;
  }
  is_newest_sent_ = false;
  if (Clock::now() - last_frame_ >= min_frame_gap || paused_) publish_newest();
}

StepFacts Session::facts_of(const evaluation::LapSetup& setup) const {
  const auto& methods = options_.choices.methods;
  const auto method = std::find(methods.begin(), methods.end(), setup.driver.method);
  return {.deadline = setup.control_period(),
          .prediction_step = setup.driver.configuration.vehicle.time_step,
          .method = static_cast<int>(method - methods.begin())};
}

/// The message of a step with its bodies, and with those of the ghost's world.
std::shared_ptr<const std::string> Session::frame_of(const Step& step, const std::string& bodies,
                                                     const std::string& ghost_bodies) {
  std::string frame = step.without_bodies + bodies;
  if (!step.ghost.empty()) frame += encode_ghost_frame(step.ghost + ghost_bodies);
  return std::make_shared<const std::string>(std::move(frame));
}

void Session::publish_newest() {
  if (std::exchange(is_newest_sent_, true) || history_.empty()) return;
  last_frame_ = Clock::now();
  server_.publish(history_.back().frame);
}

void Session::note_laps() {
  note_laps_of(*simulation_, names_.method, false);
  if (ghost_) note_laps_of(*ghost_, ghost_label_, true);
}

void Session::note_laps_of(const Simulation& simulation, const std::string& method, bool ghost) {
  const sim::LapTimer& timer = *simulation.loop().world().laps(0);
  int done = 0, before = 0;
  for (const LapNote& lap : laps_) {
    if (lap.ghost != ghost) continue;
    done = lap.lap;
    before += lap.contacts;
  }
  if (timer.laps() <= done) return;
  laps_.push_back({.tick = simulation.ticks(),
                   .lap = timer.laps(),
                   .time = timer.last_lap_time(),
                   .contacts = simulation.loop().collisions() - before,
                   .method = method,
                   .ghost = ghost});
  state_changed_ = true;
}

void Session::keep(Step step) {
  history_bytes_ += bytes_of(step);
  history_.push_back(std::move(step));
  const auto most = static_cast<std::size_t>(options_.history / simulation_->loop().setup().control_period());
  while (history_.size() > 1 && (history_.size() > most || history_bytes_ > max_history_bytes)) {
    history_bytes_ -= bytes_of(history_.front());
    history_.pop_front();
  }
}

void Session::forget_after(int tick) {
  while (!history_.empty() && history_.back().tick > tick) {
    history_bytes_ -= bytes_of(history_.back());
    history_.pop_back();
  }
  while (!laps_.empty() && laps_.back().tick > tick + 1) laps_.pop_back();
}

/// If a past tick is shown, makes it the present. The state there has been driven again (see `redrive_for`).
void Session::go_to_viewed() {
  if (viewed_ < 0) return;
  const int tick = std::exchange(viewed_, -1);
  Redrive& prepared = prepared_.value();
  simulation_->go_back(std::move(prepared.present.value()));
  if (ghost_) ghost_->go_back(std::move(prepared.ghost.value()));
  for (Redrive& each : redrives_) each.go_back(tick + 1);
  const evaluation::Driver& driver = simulation_->loop().setup().driver;
  if (names_.method != driver.method ||
      vehicle::to_yaml(configuration_) != vehicle::to_yaml(driver.configuration)) {
    names_.method = driver.method;
    configuration_ = driver.configuration;
    tell_options();
  }
  forget_after(tick);
  due_ = Clock::now();
  state_changed_ = true;
}

void Session::show(int tick) {
  if (history_.empty()) return;
  tick = std::clamp(tick, history_.front().tick, history_.back().tick);
  const auto& step = history_[static_cast<std::size_t>(tick - history_.front().tick)];
  viewed_ = tick == history_.back().tick ? -1 : tick;
  paused_ = is_newest_sent_ = true;
  server_.publish(step.frame);
  state_changed_ = true;
}

/// While nothing moves, what was edited is shown at once.
void Session::show_edit() {
  if (history_.empty()) return;
  Step& last = history_.back();
  const bool has_ghost = ghost_ && !last.ghost.empty();
  last.frame = frame_of(last, encode_bodies(simulation_->loop().world()),
                        has_ghost ? encode_bodies(ghost_->loop().world()) : std::string());
  if (paused_) server_.publish(last.frame);
}

}  // namespace slalom::view
