#include "bridge/world_core.hpp"

#include <cmath>
#include <utility>

namespace slalom_bridge {

WorldCore::WorldCore(const Settings& settings, Clocks clocks, std::function<void(const std::string&)> warn)
    : clocks_(std::move(clocks)),
      log_(clocks_.steady, std::move(warn)),
      settings_(settings),
      course_(load_course(settings.course)),
      world_(settings.course, settings.seed, settings.obstacles),
      due_(stamp_of(clocks_.now())) {}

void WorldCore::hear_drive(const std::string& voice, double steer, double speed) {
  if (!std::isfinite(steer) || !std::isfinite(speed)) return log_("a command is not finite");
  steer_ = steer;
  speed_ = speed;
  voices_[voice] = clocks_.steady();
}

/// Whether exactly one node commands the car.
bool WorldCore::commanded() {
  const double now = clocks_.steady();
  int speaking = 0;
  for (const auto& [name, at] : voices_) speaking += now - at <= settings_.command_timeout;
  if (speaking == 1) return true;
  why_ = speaking == 0 ? "no command" : "commanded by more than one";
  if (speaking == 0) return false;
  std::string names;
  for (const auto& [name, at] : voices_)
    if (now - at <= settings_.command_timeout) names += " " + name;
  log_("braking: commanded by more than one:" + names);
  return false;
}

bool WorldCore::step_if_due(Stamp& stamp) {
  constexpr Stamp furthest_ahead = 1'000'000'000, furthest_behind = 500'000'000;  // ns
  log_.flush();
  const Stamp now = stamp_of(clocks_.now());
  if (due_ > now + furthest_ahead || due_ < now - furthest_behind)
    due_ = now;  // the clock jumped, or this process was stopped
  if (now < due_) return false;
  world_.step(steer_, commanded() ? speed_ : 0);
  ++steps_;
  stamp = due_;
  due_ += period;
  return true;
}

Report WorldCore::report() {
  Report r;
  const World::Reading& seen = world_.reading();
  r.about = "simulated car";
  r.add("speed, m/s", seen.speed);
  r.add("laps", seen.laps);
  r.add("contacts", seen.contacts);
  r.message = why_.empty() ? "driving" : "braking: " + why_;
  r.level = why_.empty() ? Level::ok : Level::warning;
  why_.clear();
  return r;
}

}  // namespace slalom_bridge
