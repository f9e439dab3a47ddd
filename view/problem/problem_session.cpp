#include "view/problem/problem_session.hpp"

#include <algorithm>
#include <utility>

#include "json/json.hpp"
#include "slalom/solvers/registry.hpp"

namespace slalom::view {
namespace {

constexpr double usual_period = 0.05;  // s, where the problem does not tell the duration of its steps
// One is not always enough for a plan on the other side of an obstacle that was moved into the way.
constexpr int solves_of_change = 3;

double period_of(const Subject& subject) {
  return subject.time_step() > 0 ? subject.time_step() : usual_period;
}

/// Takes the options that all methods have.
void take_common(SolverOptions& to, const SolverOptions& from) {
  for (const OptionEntry& each : list_options(from))
    for (const char* common : {"horizon", "samples", "input_min", "input_max", "seed", "threads"})
      if (std::string_view(each.declaration.name) == common) set_option(to, common, to_text(each.value));
}

}  // namespace

const SolveResult& Run::decide() {
  return subject->solve(state, {.elapsed = std::exchange(elapsed, 0)});
}

void Run::advance() {
  state = subject->step(state, subject->inputs().first(subject->facts().inputs.size()));
  ++steps;
  elapsed = subject->time_step() > 0 ? period : 0;
}

ProblemSession::ProblemSession(std::unique_ptr<Subject> subject, Server& server) : Playback(server) {
  for (const char* name : solver_names()) choices_.methods.emplace_back(name);
  if (const SolverOptions* options = subject->options()) loaded_.emplace(options->method(), *options);
  for (const OptionEntry& each : subject->parameters())
    parameters_.emplace(each.declaration.name, to_text(each.value));
  drives_ = Run{std::move(subject), {}};
  restart();
}

/// Begins at the start, with the present options and scene.
void ProblemSession::restart() {
  Polymorphic<Subject> subject(drives_->subject->clone());
  if (const SolverOptions* options = subject->options()) subject->set_options(SolverOptions(*options));
  subject->restart();
  std::vector<double> start = subject->start();
  const double period = period_of(*subject);
  begin({std::move(subject), std::move(start), period});
  collided_.clear();
  if (paused_) tick();
}

void ProblemSession::tick() {
  pace_.step(drives_->period, rate_);
  timeline_.checkpoint(*drives_);
  keep(drive(*drives_));
}

/// Drives a run one step further and returns the frame of the step.
Frame ProblemSession::drive(Run& run) {
  const auto begin = Clock::now();
  const SolveResult& solve = run.decide();
  const double solve_time = std::chrono::duration<double>(Clock::now() - begin).count();
  const SolverOptions* options = run.subject->options();
  const auto earlier = std::lower_bound(collided_.begin(), collided_.end(), run.steps) - collided_.begin();
  Frame frame = encode_frame(*run.subject, solve,
                             {.tick = run.steps,
                              .measures = {.time = run.steps * run.period,
                                           .update_time = solve_time,
                                           .collisions = static_cast<int>(earlier)},
                              .period = run.period,
                              .prediction_step = run.period,
                              .method = choices_.method_index(options ? options->method() : ""),
                              .state = run.state});
  run.advance();
  return frame;
}

/// Keeps and shows the last step of the present run.
void ProblemSession::keep(Frame frame) {
  const int number = drives_->steps - 1;
  collided_.erase(std::lower_bound(collided_.begin(), collided_.end(), number), collided_.end());
  if (frame.collides) collided_.push_back(number);
  if (number == 0) bounds_ = frame.bounds;
  bounds_.include(frame.bounds.x0, frame.bounds.y0);
  bounds_.include(frame.bounds.x1, frame.bounds.y1);
  DrivenTick driven{number, {}, shared(std::move(frame.message))};
  driven.keep_scalars(scalars());
  timeline_.keep(std::move(driven));
  offer_newest();
}

/// Applies a change from the step that is shown on. While nothing moves, this step is driven again, so that
/// the plan that is shown belongs to the change. With another duration of steps the drive begins anew. If the
/// change, a solve or a function of the drawing throws, nothing has changed.
void ProblemSession::perform(const Timeline::Action& change) {
  const bool is_driven_again = is_held();
  const int shown = shown_tick();
  const auto action = [change, solves = is_driven_again ? solves_of_change : 1](Run& run) {
    change(run);
    for (int i = 1; i < solves; ++i) run.decide();
  };
  Run run = present();
  action(run);
  Run before = run;
  Frame frame;
  if (is_driven_again) frame = drive(run);
  edited_ = is_state_changed_ = true;
  if (period_of(*before.subject) != before.period) {
    drives_ = std::move(before);
    return restart();
  }
  if (is_driven_again) forget_after(shown - 1, shown);
  timeline_.note(before.steps, action);
  drives_ = std::move(run);
  if (!is_driven_again) return;
  timeline_.checkpoint(before, true);  // a copy in any case: going back need not repeat the changes
  held_ = std::move(before);
  keep(std::move(frame));
  publish_newest();
}

void ProblemSession::obey(std::uint64_t client, const std::string& what, const Json& command) {
  if (obey_transport(client, what, command)) return;
  const SubjectFacts& facts = drives_->subject->facts();
  if (what == "place_car" && facts.can_place) {
    const maps::Pose to{field::number(command, "x"), field::number(command, "y"),
                        field::number(command, "yaw", 0)};
    perform([to](Run& run) { run.subject->place(run.state, to); });
  } else if (what == "move" && facts.can_move) {
    const maps::Point to{field::number(command, "x"), field::number(command, "y")};
    const int shape = field::integer(command, "body") - 1;
    perform([=](Run& run) {
      const bool is_known = shape >= 0 && shape < std::ssize(run.subject->shapes());
      field::require(is_known, "body", "a shape of the scene");
      run.subject->move(shape, to);
    });
  } else if (what == "set") {
    set(field::text(command, "key"), field::text(command, "value"));
  } else if (what == "reset_options") {
    perform([loaded = loaded_, parameters = parameters_](Run& run) {
      for (const auto& [name, text] : parameters) run.subject->set_parameter(name, text);
      if (const SolverOptions* now = run.subject->options())
        run.subject->set_options(SolverOptions(loaded.at(now->method())));
    });
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
  const auto require = [key](bool is_known) {
    if (!is_known) throw std::invalid_argument(key.substr(0, 80) + ": is not an option");
  };
  if (section == "problem") {
    perform([=](Run& run) { require(run.subject->set_parameter(name, value)); });
  } else {
    const SolverOptions* present_options = present().subject->options();
    require(present_options && section == present_options->method());
    SolverOptions changed = *present_options;
    require(set_option(changed, name, value));
    field::check_samples(changed);
    perform([changed](Run& run) { run.subject->set_options(changed); });
  }
}

/// Lets another method solve, by default with horizon, samples, bounds and seed of the present one.
void ProblemSession::set_method(const std::string& method) {
  const SolverOptions* now = present().subject->options();
  if (!now) throw std::invalid_argument("method: the controller has a solver of its own");
  const std::optional<SolverOptions> given = present().subject->options_of(method);
  SolverOptions loaded = given ? *given : solver_options(method);
  if (!given) take_common(loaded, loaded_.at(now->method()));
  SolverOptions changed = loaded_.emplace(method, loaded).first->second;
  if (!given) take_common(changed, *now);
  perform([changed](Run& run) { run.subject->set_options(changed); });
}

}  // namespace slalom::view
