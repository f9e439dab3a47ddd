#pragma once

#include <algorithm>

#include "slalom/core/options.hpp"
#include "slalom/maps/moving_obstacles.hpp"
#include "support/adversary.hpp"

namespace slalom::testing {

/// Sets some options to any value in their ranges.
template <class Options>
void draw_options(Adversary& adversary, Options& options) {
  visit_options(options, [&]<class Field>(Field& field, const Declaration& declared) {
    if (!adversary.once_in(12)) return;
    const double least = std::max(declared.min, -1e12), most = std::min(declared.max, 1e12);
    const double drawn = adversary.once_in(3) ? (adversary.below(2) ? least : most)
                         : least > 0          ? least * std::pow(most / least, adversary.within(0, 1))
                                              : adversary.within(least, most);
    if constexpr (std::is_same_v<Field, bool>) {
      field = adversary.below(2) != 0;
    } else if constexpr (std::is_same_v<Field, double> || std::is_same_v<Field, int>) {
      field = static_cast<Field>(drawn);
    }
  });
}

/// Predictions of a few things that move, some of them with numbers that nothing has.
struct AnyOthers {
  static constexpr std::size_t times = 5;
  std::vector<maps::PredictedPose> poses;
  std::vector<maps::PredictedObstacle> cars;

  std::span<const maps::PredictedObstacle> draw(Adversary& adversary) {
    cars.resize(adversary.below(2) ? 0 : adversary.below(20));
    poses.resize(cars.size() * maps::PredictedObstacle::max_hypotheses * times);
    const bool hostile = adversary.once_in(3);
    const auto value = [&](double low, double high) {
      return hostile && adversary.once_in(8) ? adversary.any(low, high) : adversary.within(low, high);
    };
    std::span<maps::PredictedPose> rest(poses);
    for (maps::PredictedObstacle& car : cars) {
      car.id = adversary.below(6);
      car.length = value(0, 2);
      car.width = value(0, 2);
      car.interval = value(0.05, 1);
      car.hypotheses = hostile && adversary.once_in(8) ? adversary.below(100) - 50 : 1 + adversary.below(4);
      for (double& weight : car.weights) weight = value(0, 1);
      const int count = std::clamp(car.hypotheses, 0, maps::PredictedObstacle::max_hypotheses);
      car.poses = rest.first(static_cast<std::size_t>(count) * (hostile ? 1 : times));
      for (maps::PredictedPose& each : rest.first(car.poses.size()))
        each = {{value(0, 60), value(-2, 2), value(-4, 4)}, value(0, 1), value(0, 1)};
      rest = rest.subspan(car.poses.size());
    }
    return cars;
  }
};

}  // namespace slalom::testing
