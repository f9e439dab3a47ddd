#include "view/problem/problem_session.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "slalom/solvers/registry.hpp"
#include "src/evaluation/json.hpp"

namespace slalom::view {
namespace {

constexpr auto min_frame_gap = std::chrono::milliseconds(12);  // no screen shows more
constexpr auto max_state_gap = std::chrono::seconds(1);
constexpr double usual_period = 0.05;  // s, where the problem does not tell the duration of its steps
constexpr int max_late_steps = 4;      // steps that a late clock may owe
constexpr int max_steps = 400;         // most steps of a command "step"

std::shared_ptr<const std::string> shared(std::string text) {
  return std::make_shared<const std::string>(std::move(text));
}

/// Estimates the bytes of a copy of a controller: the batch of samples, and other arrays of that order.
std::size_t bytes_of(const SolveResult& solve) {
  const SequenceBatch* batch = solve.samples;
  if (!batch) return 1;
  return std::size_t{8} * sizeof(float) * static_cast<std::size_t>(batch->samples()) *
         static_cast<std::size_t>(batch->steps()) * static_cast<std::size_t>(batch->inputs());
}

}  // namespace

const SolveResult& Run::decide() {
  const double elapsed = steps > 0 && subject->time_step() > 0 ? period : 0;
  return subject->solve(state, {.elapsed = elapsed});
}

void Run::advance() {
  state = subject->step(state, subject->inputs().first(subject->facts().inputs.size()));
  ++steps;
}

ProblemSession::ProblemSession(std::unique_ptr<Subject> subject, Server& server)
    : server_(server), audience_(server) {
  for (const char* name : solver_names()) methods_.emplace_back(name);
  period_ = subject->time_step() > 0 ? subject->time_step() : usual_period;
  if (const SolverOptions* options = subject->options()) loaded_.emplace(options->method(), *options);
  for (const OptionEntry& each : subject->parameters())
    parameters_.emplace(each.declaration.name, to_text(each.value));
  run_ = Run{std::move(subject), {}, period_};
  restart();
}

/// Begins at the start, with the present options and scene.
void ProblemSession::restart() {
  Polymorphic<Subject> subject(run_->subject->clone());
  if (const SolverOptions* options = subject->options()) subject->set_options(SolverOptions(*options));
  std::vector<double> start = subject->start();
  run_ = Run{std::move(subject), std::move(start), period_};
  timeline_ = Timeline(period_);
  held_.reset();
  viewed_ = -1;
  steps_left_ = 0;
  ++generation_;
  due_ = paced_ = Clock::now();
  is_state_changed_ = true;
}

void ProblemSession::turn(std::chrono::nanoseconds at_most) {
  const auto wait = std::min<Clock::duration>(until_due(), at_most);
  if (wait > Clock::duration::zero()) server_.wait(wait);
  for (const Received& each : server_.take()) {
    if (each.kind == Received::Kind::joined)
      join(each.client);
    else if (each.kind == Received::Kind::left)
      audience_.leave(each.client);
    else {
      const Json command = parse_json_or_null(each.text);
      audience_.execute(each.client, command,
                        [&](const std::string& what) { obey(each.client, what, command); });
    }
  }
  if (until_due() <= Clock::duration::zero()) {
    if (steps_left_ > 0) --steps_left_;
    tick();
  }
  if (paused_ && is_held()) present();  // the first change after a pause need not wait for it
  const auto now = Clock::now();
  if (server_.clients() == 0 || !(is_state_changed_ || now - last_state_ > max_state_gap)) return;
  last_state_ = now;
  is_state_changed_ = false;
  measure_pace();
  audience_.tell(0, state());
}

ProblemSession::Clock::duration ProblemSession::until_due() const {
  if (steps_left_ > 0) return Clock::duration::zero();
  if (waiting_ || paused_) return std::chrono::hours(1);
  if (rate_ <= 0) return Clock::duration::zero();
  return due_ - Clock::now();
}

void ProblemSession::tick() {
  if (rate_ > 0) {
    const auto step =
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(period_ / rate_));
    due_ = std::max(due_ + step, Clock::now() - max_late_steps * step);
  }
  Run& run = *run_;
  timeline_.checkpoint(run, copy_bytes_, solve_time_);
  const auto begin = Clock::now();
  const SolveResult& solve = run.decide();
  solve_time_ = std::chrono::duration<double>(Clock::now() - begin).count();
  copy_bytes_ = bytes_of(solve);
  const auto method =
      std::ranges::find(methods_, run.subject->options() ? run.subject->options()->method() : "");
  ProblemFrame frame = encode_step(*run.subject, solve,
                                   {.tick = run.steps,
                                    .time = run.steps * period_,
                                    .period = period_,
                                    .solve_time = solve_time_,
                                    .collisions = run.collisions,
                                    .method = static_cast<int>(method - methods_.begin()),
                                    .state = run.state});
  run.collisions += frame.collides;
  if (run.steps == 0) bounds_ = frame.bounds;
  bounds_.include(frame.bounds.x0, frame.bounds.y0);
  bounds_.include(frame.bounds.x1, frame.bounds.y1);
  const int number = run.steps;
  run.advance();
  ++paced_ticks_;
  timeline_.keep({number, {}, shared(std::move(frame.message))});
  if (paused_ || Clock::now() - last_frame_ >= min_frame_gap) publish(number);
}

void ProblemSession::publish(int tick) {
  last_frame_ = Clock::now();
  server_.publish(0, timeline_.at(tick).frame);
}

/// Pauses and shows a stored step.
void ProblemSession::show_step(int tick) {
  if (timeline_.empty()) return;
  tick = std::clamp(tick, timeline_.oldest(), timeline_.newest());
  viewed_ = tick == timeline_.newest() ? -1 : tick;
  paused_ = is_state_changed_ = true;
  publish(tick);
}

/// Makes the step that is shown the newest one.
void ProblemSession::continue_from_shown() {
  if (viewed_ < 0) return;
  Run run = present();
  run.tick({});
  run_ = std::move(run);
  timeline_.forget_after(viewed_, viewed_);
  viewed_ = -1;
  due_ = Clock::now();
}

/// Whether a change is to be shown before the next step: the drive is paused, or in slow motion.
bool ProblemSession::is_held() const {
  constexpr double longest_wait = 0.05;  // s
  const bool is_slow = rate_ > 0 && period_ > longest_wait * rate_;
  return (paused_ || is_slow) && steps_left_ == 0 && !timeline_.empty();
}

/// Returns the run that a change applies to: while nothing moves, as it was when the step that is shown
/// began.
const Run& ProblemSession::present() {
  if (!is_held()) return *run_;
  if (!held_ || held_->steps != shown_tick()) held_ = timeline_.before(shown_tick());
  return *held_;
}

/// Applies an action from the step that is shown on. While nothing moves, this step is driven again, so that
/// the plan that is shown belongs to the change. If the action throws, nothing has changed.
void ProblemSession::perform(const Timeline::Action& action) {
  const bool is_driven_again = is_held();
  const int shown = shown_tick();
  Run run = present();
  action(run);
  run_ = std::move(run);
  if (is_driven_again) timeline_.forget_after(shown - 1, shown);
  timeline_.note(run_->steps, action);
  edited_ = is_state_changed_ = true;
  viewed_ = -1;
  if (!is_driven_again) return;
  held_ = *run_;
  const Clock::time_point due = due_;
  tick();
  publish(timeline_.newest());
  due_ = due;
}

void ProblemSession::obey(std::uint64_t client, const std::string& what, const Json& command) {
  if (what == "past")
    return tell_past(client, field::integer(command, "from"), field::integer(command, "to"));
  if (what == "take_over") return audience_.take_over(client);
  audience_.require_driver(client);
  is_state_changed_ = true;
  const SubjectFacts& facts = run_->subject->facts();
  if (what == "pause") {
    paused_ = true;
    steps_left_ = 0;
    if (!timeline_.empty()) publish(shown_tick());
  } else if (what == "play" || what == "step") {
    continue_from_shown();
    waiting_ = false;
    paused_ = what == "step";
    steps_left_ = paused_ ? std::clamp(field::integer(command, "ticks", 1), 1, max_steps) : 0;
    due_ = paced_ = Clock::now();
    paced_ticks_ = 0;
  } else if (what == "seek") {
    steps_left_ = 0;
    show_step(field::integer(command, "tick"));
  } else if (what == "rate") {
    rate_ = field::number(command, "rate");
    field::require(rate_ == 0 || (rate_ >= 0.001 && rate_ <= 100), "rate",
                   "0 for the maximum speed, or in [0.001, 100]");
    due_ = Clock::now();
  } else if (what == "restart") {
    restart();
    paused_ = false;
  } else if (what == "place_car" && facts.can_place) {
    const maps::Pose to{field::number(command, "x"), field::number(command, "y"),
                        field::number(command, "yaw", 0)};
    perform([to](Run& run) { run.subject->place(run.state, to); });
  } else if (what == "move" && facts.can_move) {
    const maps::Point to{field::number(command, "x"), field::number(command, "y")};
    const int shape = field::integer(command, "body") - 1;
    field::require(shape >= 0 && shape < std::ssize(run_->subject->shapes()), "body", "a shape of the scene");
    perform([=](Run& run) { run.subject->move(shape, to); });
  } else if (what == "set") {
    set(field::text(command, "key"), field::text(command, "value"));
  } else if (what == "reset_options") {
    if (run_->subject->options()) {
      const SolverOptions options = loaded_.at(run_->subject->options()->method());
      perform([options](Run& run) { run.subject->set_options(options); });
    }
    for (const auto& [name, text] : parameters_) set("problem." + name, text);
    audience_.tell(0, options());
  } else if (what == "method") {
    set_method(field::text(command, "method"));
  } else {
    throw MalformedCommand("do: '" + what.substr(0, 40) + "' is not a command of this page");
  }
}

/// Sets "method.option" or "problem.parameter".
void ProblemSession::set(const std::string& key, const std::string& value) {
  const auto dot = key.find('.');
  const std::string section = key.substr(0, dot), name = dot == std::string::npos ? "" : key.substr(dot + 1);
  const auto require = [&](bool is_known) {
    if (!is_known) throw std::invalid_argument(key.substr(0, 80) + ": is not an option");
  };
  if (section == "problem") {
    perform([=](Run& run) { require(run.subject->set_parameter(name, value)); });
  } else {
    const SolverOptions* present_options = present().subject->options();
    require(present_options && section == present_options->method());
    SolverOptions changed = *present_options;
    require(set_option(changed, name, value));
    perform([changed](Run& run) { run.subject->set_options(changed); });
  }
  audience_.tell(0, options());
}

/// Lets another method solve, with the horizon, samples, bounds and seed of the present one.
void ProblemSession::set_method(const std::string& method) {
  const SolverOptions* now = present().subject->options();
  if (!now) throw std::invalid_argument("method: the controller has a solver of its own");
  const auto known = loaded_.find(method);
  SolverOptions changed = known == loaded_.end() ? solver_options(method) : known->second;
  for (const OptionEntry& each : list_options(*now))
    for (const char* common : {"horizon", "samples", "input_min", "input_max", "seed", "threads"})
      if (std::string_view(each.declaration.name) == common) set_option(changed, common, to_text(each.value));
  perform([changed](Run& run) { run.subject->set_options(changed); });
  loaded_.emplace(method, changed);
  audience_.tell(0, options());
}

/// Measures the simulated time per time while the drive goes on.
void ProblemSession::measure_pace() {
  const auto now = Clock::now();
  const double passed = std::chrono::duration<double>(now - paced_).count();
  if (paused_) pace_ = 0;
  if (passed < 0.5 && !paused_) return;
  if (!paused_) pace_ = paced_ticks_ * period_ / passed;
  paced_ = now;
  paced_ticks_ = 0;
}

}  // namespace slalom::view
