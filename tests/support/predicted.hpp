#pragma once

#include "slalom/maps/moving_obstacles.hpp"

namespace slalom::testing {

/// A prediction of a body that moves along its yaw from a pose, at one speed in each hypothesis.
struct Predicted {
  struct Hypothesis {
    double weight;
    maps::Pose from;
    double speed = 0;              ///< m/s
    double along = 0, across = 0;  ///< m, standard deviations
  };
  Predicted(double length, double width, const std::vector<Hypothesis>& hypotheses, int times = 17,
            double interval = 0.1) {
    for (std::size_t h = 0; h < hypotheses.size(); ++h) {
      const Hypothesis& each = hypotheses[h];
      obstacle.weights[h] = each.weight;
      for (int k = 0; k < times; ++k) {
        const double way = interval * k * each.speed;
        poses.push_back({{each.from.x + way * std::cos(each.from.yaw),
                          each.from.y + way * std::sin(each.from.yaw), each.from.yaw},
                         each.along,
                         each.across});
      }
    }
    obstacle.length = length;
    obstacle.width = width;
    obstacle.interval = interval;
    obstacle.hypotheses = static_cast<int>(hypotheses.size());
    obstacle.poses = poses;
  }
  Predicted(const Predicted&) = delete;
  std::vector<maps::PredictedPose> poses;
  maps::PredictedObstacle obstacle;
};

}  // namespace slalom::testing
