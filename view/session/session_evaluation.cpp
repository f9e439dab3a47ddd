#include <algorithm>
#include <stdexcept>

#include "view/session/session.hpp"

#include "slalom/evaluation/json.hpp"
#include "view/session/command_fields.hpp"

namespace slalom::view {
namespace {

constexpr double before_contact = 2.0, after_contact = 0.25;  // s shown
constexpr double slow = 0.25;                                 // of simulated to real time

}  // namespace

/// The tick of a collision in a lap. Drives the lap to find it.
int Session::tick_of_contact(int contact) {
  const evaluation::LapRunner& runner = simulation_->loop().runner();
  const double period = runner.control_period();
  const int most = static_cast<int>(runner.timeout() / period) + 1;
  const auto collisions = [&] { return simulation_->loop().first_collisions(); };
  while (std::ssize(collisions()) <= contact && simulation_->ticks() < most) simulation_->tick({}, false);
  if (std::ssize(collisions()) <= contact)
    throw std::runtime_error("the repeated lap has no such collision: another version drove the evaluation");
  return static_cast<int>(collisions()[static_cast<std::size_t>(contact)].time / period);
}

/// A lap of the evaluation: from its start, or the seconds before one of its collisions.
void Session::handle_lap(const Json& command) {
  if (!options_.load_lap) throw std::invalid_argument("lap: no evaluation is open");
  const int experiment = field::integer(command, "experiment"), lap = field::integer(command, "lap"),
            contact = command.contains("contact") ? field::integer(command, "contact") : -1;
  note("Driving lap " + std::to_string(lap) + " again \xE2\x80\xA6");
  LoadedLap loaded = options_.load_lap(experiment, lap);
  install(std::move(loaded.scenario), loaded.names);
  waiting_ = real_time_ = paused_ = false;
  rate_ = 1;
  int hit = -1;
  if (contact >= 0) {
    hit = tick_of_contact(contact);
    const double period = simulation_->loop().runner().control_period();
    simulation_->seek(std::max(0, hit - static_cast<int>(before_contact / period)));
    stop_at_ = hit + static_cast<int>(after_contact / period);
    rate_ = slow;
  }
  contact_ = {experiment, lap, contact, hit};
  due_ = Clock::now();
}

}  // namespace slalom::view
