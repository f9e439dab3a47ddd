#include "slalom/evaluation/grip_learning.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::evaluation {
namespace {

constexpr double raised = 1.03;           // at most, from one lap to the next
constexpr double lowered = 0.94;          // at least, where a lap went beyond the circle
constexpr double after_collision = 0.92;  // where a lap ended early, and in the part before
constexpr double caution =
    0.99;  // share of the grip that went beyond the circle: more is never asked for again
constexpr double use_quantile = 0.95;  // quantile of the accelerations in a part
constexpr double gain = 1e-3;          // share of the lap time
constexpr double limited = 0.7;  // share of the circle: a part that takes less is not limited by the grip

void require(bool holds, const char* what, double value, const char* rule) {
  if (!holds)
    throw std::invalid_argument(std::string(what) + ": " + std::to_string(value) + " must be " + rule);
}

}  // namespace

vehicle::Configuration with_belief(const vehicle::Configuration& configuration, const GripBelief& belief) {
  vehicle::Configuration made = configuration;
  const double largest = *std::max_element(belief.begin(), belief.end());
  std::vector<double> shares;
  for (const double each : belief) shares.push_back(each / largest);
  made.vehicle.own_of<vehicle::SingleTrackOptions>().usable_grip = largest;
  made.planner.grip_shares = PerInput(std::move(shares));
  return made;
}

GripLearning::GripLearning(double length, double start, int parts, double belief, double circle)
    : length_(length), start_(start), circle_(circle), best_time_(std::numeric_limits<double>::infinity()) {
  require(length > 0, "length", length, "above 0");
  require(start >= 0, "start", start, "at least 0");
  require(parts >= 1, "parts", parts, "at least 1");
  require(belief >= least && belief <= most, "belief", belief, "in [0.3, 1]");
  require(circle > 0, "circle", circle, "above 0");
  next_.assign(static_cast<std::size_t>(parts), belief);
  most_.assign(next_.size(), most);
}

int GripLearning::part_at(double distance) const noexcept {
  const double way = std::fmod(start_ + std::max(distance, 0.0), length_) / length_;
  const auto parts = static_cast<int>(next_.size());
  return std::min(saturate_cast<int>(way * parts), parts - 1);
}

/// m/s^2, the acceleration that each part took; 0 where the lap did not come.
std::vector<double> GripLearning::use(const RacingLap& lap) const {
  std::vector<std::vector<double>> accelerations(next_.size());
  for (const RacingSample& sample : lap.samples)
    accelerations[static_cast<std::size_t>(part_at(sample.distance))].push_back(
        std::hypot(sample.longitudinal, sample.lateral));
  std::vector<double> used;
  for (std::vector<double>& part : accelerations) {
    std::sort(part.begin(), part.end());
    const double rank = use_quantile * (static_cast<double>(part.size()) - 1);
    used.push_back(part.empty() ? 0 : part[saturate_cast<std::size_t>(std::round(std::max(rank, 0.0)))]);
  }
  return used;
}

void GripLearning::lower(int part) noexcept {
  const std::size_t parts = next_.size(), i = (static_cast<std::size_t>(part) + parts) % parts;
  most_[i] = std::min(most_[i], after_collision * next_[i]);
}

void GripLearning::learn(const RacingLap& lap) {
  ++without_gain_;
  if (lap.end != RacingEnd::completed) {
    const int end = part_at(lap.samples.back().distance);
    lower(end);
    lower(end - 1);
    if (!best_.empty()) next_ = best_;
  } else {
    if (lap.time() < (1 - gain) * best_time_) without_gain_ = 0;
    if (lap.time() < best_time_) best_time_ = lap.time(), best_ = next_;
    const std::vector<double> used = use(lap);
    for (std::size_t i = 0; i < next_.size(); ++i) {
      if (used[i] > circle_) most_[i] = std::min(most_[i], caution * next_[i]);
      if (used[i] > limited * circle_) next_[i] *= std::clamp(circle_ / used[i], lowered, raised);
    }
  }
  for (std::size_t i = 0; i < next_.size(); ++i) next_[i] = std::max(std::min(next_[i], most_[i]), least);
}

}  // namespace slalom::evaluation
