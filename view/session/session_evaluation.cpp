#include <memory>
#include <stdexcept>
#include <utility>

#include "view/session/session.hpp"

#include "src/evaluation/json.hpp"
#include "view/session/command_fields.hpp"

namespace slalom::view {
namespace {

constexpr double before_contact = 2.0, after_contact = 0.25;  // s shown
constexpr double slow = 0.25;                                 // of simulated to real time

}  // namespace

LoadedLap Session::load_lap(const Json& command) {
  if (!options_.load_lap) throw std::invalid_argument("lap: no evaluation is open");
  const int experiment = field::integer(command, "experiment"), lap = field::integer(command, "lap");
  note("Driving lap " + std::to_string(lap) + " again \xE2\x80\xA6");
  return options_.load_lap(experiment, lap);
}

/// Begins to look for the collision that a command asks for, while the drive continues.
void Session::search_contact(Redrive& redrive, const Json& command) {
  const int contact = field::integer(command, "contact");
  const LoadedLap& loaded = redrive.lap.emplace(load_lap(command));
  const LoadedScenario& scenario = loaded.scenario;
  redrive.search.emplace(
      evaluation::LapSetup{scenario.environment, {scenario.configuration, loaded.names.method}, scenario.lap},
      loaded.names.seed, contact, before_contact);
}

/// A lap of the evaluation: from its start, or the seconds before one of its collisions.
void Session::handle_lap(const Json& command) {
  const int experiment = field::integer(command, "experiment"), lap = field::integer(command, "lap"),
            contact = command.contains("contact") ? field::integer(command, "contact") : -1;
  LoadedLap loaded = contact >= 0 ? std::move(prepared_.value().lap.value()) : load_lap(command);
  install(std::move(loaded.scenario), loaded.names);
  waiting_ = real_time_ = paused_ = false;
  rate_ = 1;
  int hit = -1;
  if (contact >= 0) {
    ContactSearch& search = prepared_.value().search.value();
    hit = search.hit();
    simulation_->go_back(std::move(search.start()));
    stop_at_ = hit + static_cast<int>(after_contact / simulation_->loop().setup().control_period());
    rate_ = slow;
  }
  contact_ = {experiment, lap, contact, hit};
  due_ = Clock::now();
}

}  // namespace slalom::view
