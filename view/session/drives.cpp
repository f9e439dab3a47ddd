#include "view/session/drives.hpp"

#include "slalom/solvers/registry.hpp"
#include "view/server/audience.hpp"

namespace slalom::view {
namespace {

constexpr double usual_period = 0.05;  // s, where the subject does not tell the duration of its steps

/// An action that changes the scenes of both in the same way.
template <class Edit>
Action edit_scenes(Edit edit) {
  return [edit = std::move(edit)](Drives& drives) {
    drives.edited = true;
    edit(*drives.driven.subject);
    if (drives.ghost) edit(*drives.ghost->subject);
  };
}

void require_shape(Subject& subject, int shape) {
  field::require(shape >= 0 && shape < std::ssize(subject.shapes()), "body", "a shape of the scene");
}

void apply(Run& run) {
  if (const SolverOptions* options = run.subject->options()) field::check_samples(*options);
  run.subject->apply();
  run.settings = std::make_shared<const Settings>(settings_of(*run.subject));
}

void set_texts(Subject& subject, const OptionTexts& texts) {
  std::optional<SolverOptions> own;
  if (const SolverOptions* now = subject.options()) own = *now;
  bool is_own_changed = false;
  for (const auto& [key, text] : texts) {
    const auto dot = key.find('.');
    const std::string section = key.substr(0, dot), name = key.substr(dot + 1);
    const bool is_own = own && (dot == std::string::npos || section == own->method());
    bool is_known = false;
    try {
      is_known = is_own ? set_option(*own, name, text) : subject.set_parameter(section, name, text);
    } catch (const std::invalid_argument& error) {
      const bool is_named = std::string_view(error.what()).find(name) != std::string_view::npos;
      throw std::invalid_argument((is_named ? "" : key + ": ") + error.what());
    }
    if (!is_known) throw std::invalid_argument(key.substr(0, 80) + ": is not an option");
    is_own_changed = is_own_changed || is_own;
  }
  if (is_own_changed) subject.set_options(*own);
}

}  // namespace

void SolverSubject::restart() {
  time_ = 0;
  if (const SolverOptions* now = options()) set_options(SolverOptions(*now));
}

std::vector<double> SolverSubject::drive(std::span<const double> state, const DriveRequest& request,
                                         const OnPlan& on_plan) {
  using Clock = std::chrono::steady_clock;
  const SolveResult* solved = nullptr;
  Clock::time_point begin;
  for (int i = 0; i < request.solves; ++i) {
    begin = Clock::now();
    solved = &solve(state, {.elapsed = i == 0 ? request.elapsed : 0});
  }
  if (solved && on_plan) on_plan(*solved, std::chrono::duration<double>(Clock::now() - begin).count());
  time_ += time_step();
  return step(state, inputs().first(facts().inputs.size()));
}

Run::Run(Polymorphic<Subject> made)
    : subject(std::move(made)),
      settings(std::make_shared<const Settings>(settings_of(*subject))),
      state(subject->start()),
      period(subject->time_step() > 0 ? subject->time_step() : usual_period) {}

void Run::tick(StepRecord& record, const Subject::OnPlan& on_plan) {
  state = subject->drive(state, {elapsed, record.delay, record.solves}, on_plan);
  ++steps;
  collisions += record.collides;
  elapsed = subject->time_step() > 0 ? period : 0;
}

void Drives::tick(std::array<StepRecord, 2> records) {
  if (ghost) ghost->tick(records[1], {});
  driven.tick(records[0], {});
}

Drives Drives::restarted() const {
  const auto begin = [](const Run& run) {
    Polymorphic<Subject> subject(run.subject->clone());
    subject->restart();
    return Run(std::move(subject));
  };
  Drives drives{begin(driven)};
  if (ghost) drives.ghost = begin(*ghost);
  drives.ghost_label = ghost_label;
  return drives;
}

std::vector<DrivenLap> Drives::laps() const {
  const auto own = driven.subject->laps();
  std::vector<DrivenLap> all(own.begin(), own.end());
  if (ghost)
    for (DrivenLap lap : ghost->subject->laps()) {
      lap.ghost = true;
      if (lap.end > ghost_start) all.push_back(std::move(lap));
    }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.end < b.end; });
  return all;
}

OptionTexts Settings::texts() const {
  OptionTexts texts;
  add_texts(texts, sections);
  return texts;
}

Settings settings_of(const Subject& subject) {
  Settings settings;
  if (const SolverOptions* options = subject.options()) {
    settings.method = options->method();
    settings.sections.push_back({settings.method, list_options(*options)});
  }
  for (OptionSection& each : subject.parameters()) settings.sections.push_back(std::move(each));
  return settings;
}

OptionTexts changed_texts(const Settings& settings, const OptionTexts& wanted) {
  OptionTexts changed;
  for (const auto& [key, text] : settings.texts())
    if (const auto to = wanted.find(key); to != wanted.end() && to->second != text) changed.insert(*to);
  return changed;
}

SolverOptions method_options(const Subject& subject, const std::string& method, const OptionTexts& texts,
                             const std::string& present) {
  if (!subject.options()) throw std::invalid_argument("method: the controller has a solver of its own");
  if (std::optional<SolverOptions> given = subject.options_of(method)) return *std::move(given);
  SolverOptions options = solver_options(method);
  for (const char* common : {"horizon", "samples", "input_min", "input_max", "seed", "threads"})
    if (const auto now = texts.find(present + "." + common); now != texts.end())
      set_option(options, common, now->second);
  return options;
}

Action add_shape(const Shape& shape) {
  constexpr std::size_t most = 512;
  return edit_scenes([shape](Subject& subject) {
    if (subject.shapes().size() >= most) throw std::invalid_argument("bodies: at most 512 are supported");
    subject.add(shape);
  });
}

Action move_shape(int shape, const maps::Pose& to) {
  return edit_scenes([=](Subject& subject) {
    require_shape(subject, shape);
    subject.move(shape, to);
  });
}

Action remove_shape(int shape) {
  return edit_scenes([shape](Subject& subject) {
    require_shape(subject, shape);
    subject.remove(shape);
  });
}

Action set_shapes(std::vector<Shape> shapes) {
  return edit_scenes([shapes = std::move(shapes)](Subject& subject) {
    const auto moves_itself = [](const Shape& shape) {
      return shape.kind == ShapeKind::mover || shape.kind == ShapeKind::opponent;
    };
    if (subject.facts().can_add) {  // with the numbers that they had
      for (int i = static_cast<int>(subject.shapes().size()) - 1; i >= 0; --i)
        if (!moves_itself(subject.shapes()[static_cast<std::size_t>(i)])) subject.remove(i);
      for (const Shape& shape : shapes)
        if (!moves_itself(shape)) subject.add(shape);
      return;
    }
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const maps::Pose now = subject.shapes().at(i).pose, &to = shapes[i].pose;
      if (!moves_itself(shapes[i]) && (now.x != to.x || now.y != to.y || now.yaw != to.yaw))
        subject.move(static_cast<int>(i), to);
    }
  });
}

Action place_body(const maps::Pose& to) {
  return [to](Drives& drives) {
    drives.edited = true;
    drives.driven.subject->place(drives.driven.state, to);
  };
}

Action set_options(OptionTexts texts) {
  return [texts = std::move(texts)](Drives& drives) {
    drives.edited = true;
    set_texts(*drives.driven.subject, texts);
    apply(drives.driven);
  };
}

Action change_method(SolverOptions options) {
  return [options = std::move(options)](Drives& drives) {
    drives.edited = true;
    drives.driven.subject->set_options(options);
    apply(drives.driven);
  };
}

Action restore(Settings settings) {
  return [settings = std::move(settings)](Drives& drives) {
    drives.edited = true;
    Subject& subject = *drives.driven.subject;
    const OptionTexts wanted = settings.texts();
    if (subject.options() && subject.options()->method() != settings.method)
      subject.set_options(method_options(subject, settings.method, wanted, settings.method));
    set_texts(subject, changed_texts(settings_of(subject), wanted));
    apply(drives.driven);
  };
}

Action start_ghost(std::string label, std::optional<SolverOptions> method) {
  return [label = std::move(label), method = std::move(method)](Drives& drives) {
    drives.ghost = drives.driven;
    drives.ghost_label = label;
    drives.ghost_start = drives.ticks();
    if (!method) return;
    drives.ghost->subject->set_options(*method);
    apply(*drives.ghost);
  };
}

void end_ghost(Drives& drives) {
  drives.ghost.reset();
  drives.ghost_label.clear();
}

}  // namespace slalom::view
