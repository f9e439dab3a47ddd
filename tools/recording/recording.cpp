#include "tools/recording/recording.hpp"

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/files/write_file.hpp"
#include "slalom/core/version.hpp"
#include "tools/live_view/view_setup.hpp"

namespace slalom::tools {
namespace {

view::RecorderOptions recorder_options(const RecordingFacts& facts) {
  const sim::WorldOptions world = facts.scenario.environment->world_options();
  return {.program = std::string("slalom ") + version(),
          .settings = {{"settings", json_text(facts.settings)}},
          .lidar_angle_min = world.lidar.angle_min(),
          .lidar_angle_increment = world.lidar.angle_increment(),
          .everything = facts.everything,
          .wall_clock = facts.times};
}

}  // namespace

Recording::Recording(const std::string& file, const RecordingFacts& facts)
    : file_(file),
      facts_(view::car_facts(facts.scenario.environment.get())),
      prediction_step_(facts.scenario.configuration.vehicle.time_step),
      choices_(choices()),
      control_period_(facts.control_period),
      stream_(file, std::ios::binary),
      recorder_(stream_, recorder_options(facts)) {
  if (!stream_) throw cannot_write(file);
  const evaluation::Environment& environment = *facts.scenario.environment;
  state_.names = view::with_course({.course = environment.course.name,
                                    .method = facts.method,
                                    .config = facts.arguments.config,
                                    .seed = facts.seed,
                                    .obstacles = facts.scenario.lap.obstacles,
                                    .opponents = facts.scenario.lap.opponents},
                                   environment);
  state_.control_period = control_period_;
  state_.bounds = view::bounds_of(facts_->course);
  recorder_.add_text(view::hello_message(*facts_, choices_, 0, control_period_));
  recorder_.add_course(view::encode_scene(*facts_));
  recorder_.add_text(
      view::options_message({.names = state_.names,
                             .sections = view::sections_of(facts.scenario.configuration, facts.method),
                             .fixes_seed = true,
                             .further_arguments = further_arguments(facts.arguments)}));
}

void Recording::begin_lap(std::uint64_t seed) {
  state_.names.seed = seed;
  recorder_.begin_drive();
  tell_state();
}

void Recording::add(const evaluation::ControlStep& tick) {
  ++ticks_;
  recorder_.add_frame(view::encode_car(facts_, tick, control_period_, prediction_step_,
                                       choices_.method_index(state_.names.method)));
}

void Recording::end_lap(const evaluation::LapResult& lap, int number) {
  if (!lap.finished) return;
  state_.laps.push_back({.end = ticks_,
                         .lap = number,
                         .time = lap.time,
                         .contacts = lap.collisions,
                         .method = state_.names.method});
  tell_state();
}

void Recording::close() {
  recorder_.finish();
  stream_.close();
  if (!stream_) throw cannot_write(file_);
}

void Recording::tell_state() {
  recorder_.add_text(view::state_message(state_));
}

}  // namespace slalom::tools
