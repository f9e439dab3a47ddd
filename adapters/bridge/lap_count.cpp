#include "bridge/convert.hpp"
#include "slalom/sim/laps.hpp"

namespace slalom_bridge {
namespace {

slalom::sim::LapPath path_of(const std::vector<Waypoint>& waypoints) {
  std::vector<slalom::maps::Point> points;
  for (const Waypoint& w : waypoints) points.push_back({w.x, w.y});
  return slalom::sim::LapPath(std::move(points));
}

}  // namespace

struct LapCount::Hidden {
  slalom::sim::LapPath path;
  slalom::sim::LapTimer timer;
  bool started = false;

  explicit Hidden(const std::vector<Waypoint>& waypoints) : path(path_of(waypoints)), timer(path, 1) {}
};

LapCount::LapCount() = default;
LapCount::LapCount(const std::vector<Waypoint>& path) : hidden_(std::make_unique<Hidden>(path)) {}
LapCount::~LapCount() = default;
LapCount::LapCount(LapCount&&) noexcept = default;
LapCount& LapCount::operator=(LapCount&&) noexcept = default;

void LapCount::restart() {
  if (hidden_) hidden_->started = false;
}

void LapCount::update(const Pose& pose, double time) {
  if (!hidden_) return;
  if (hidden_->started) return hidden_->timer.update(hidden_->path, {pose.x, pose.y}, time);
  hidden_->started = true;
  hidden_->timer.reset(hidden_->path, {pose.x, pose.y}, time);
}

int LapCount::laps() const {
  return hidden_ && hidden_->started ? hidden_->timer.laps() : 0;
}

}  // namespace slalom_bridge
