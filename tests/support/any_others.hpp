#pragma once

#include "slalom/maps/moving_obstacles.hpp"
#include "support/adversary.hpp"

namespace slalom::testing {

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
