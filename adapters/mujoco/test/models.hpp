#pragma once

#include <cmath>
#include <string>

#include "slalom/core/problem.hpp"
#include "slalom/mujoco/model.hpp"
#include "support/temporary_folder.hpp"

namespace slalom::mujoco::testing {

/// A ball that a motor pushes along a line above the floor. `options` stands before the world.
inline std::string ball(
    const std::string& options = "",
    const std::string& actuators = R"(<motor joint="slide" ctrllimited="true" ctrlrange="-2 3"/>)") {
  return R"(<mujoco>)" + options + R"(
    <worldbody>
      <geom name="floor" type="plane" size="9 9 1" pos="0 0 -1"/>
      <body name="ball">
        <joint name="slide" type="slide" axis="1 0 0"/>
        <joint name="height" type="slide" axis="0 0 1"/>
        <geom type="sphere" size="0.1" mass="2"/>
      </body>
    </worldbody>
    <actuator>)" +
         actuators + R"(</actuator>
  </mujoco>)";
}

/// A task that costs the distance of the ball to a goal.
struct Reach {
  static constexpr int positions = 2, velocities = 2, inputs = 1;
  double goal = 0.5;  ///< m
  double wall = 1e9;  ///< m, beyond which it collides

  Cost<double> stage_cost(const mjModel&, const mjData& data) const {
    const double ball = data.xpos[3];
    return {(ball - goal) * (ball - goal) + 0.01 * data.ctrl[0] * data.ctrl[0], ball > wall};
  }
  double terminal_cost(const mjModel&, const mjData& data) const {
    return 10 * std::abs(data.xpos[3] - goal);
  }
};

/// Base of tests that load models.
class ModelTest : public slalom::testing::TemporaryFolder {
 protected:
  Model load(const std::string& text) const { return Model(write("model.xml", text)); }
};

}  // namespace slalom::mujoco::testing
