"""A robot drives from A to B in a hall, a map of ROS map_server, as numpy callables."""

from pathlib import Path

import numpy as np
import slalom
from seeds import report, succeeded

DT, RADIUS, MARGIN = np.float32(0.1), np.float32(0.3), np.float32(0.2)  # s, m, m
GOAL_X, GOAL_Y = np.float32(12.5), np.float32(7)  # m
walls = slalom.signed_distance(slalom.load_ros_map(str(Path(__file__).parents[1] / "hall" / "hall.yaml")))


def dynamics(s, u):  # inputs: speed, m/s; yaw rate, rad/s
    x, y, yaw = s.T
    return np.stack([x + DT * u[:, 0] * np.cos(yaw), y + DT * u[:, 0] * np.sin(yaw), yaw + DT * u[:, 1]]).T


def distance(s):
    return np.hypot(s[:, 0] - GOAL_X, s[:, 1] - GOAL_Y)


def clearance(s):
    return walls.value(s[:, 0], s[:, 1]) - RADIUS


def cost(s, u):
    clear = clearance(s)
    too_near = np.maximum(MARGIN - clear, 0)
    hit = clear < 0
    return DT * (distance(s) + np.float32(0.05) * u[:, 1] ** 2 + 20 * too_near**2) + 100 * hit, hit


robot = slalom.Problem(dynamics, cost, lambda s: 3 * distance(s), states=3, inputs=2, dt=float(DT),
                       input_min=[-0.5, -2], input_max=[1.5, 2], input_rate_max=[2, 8])


def arrives(controller):
    """Whether the robot is within 0.3 m of B after at most 20 s, without a collision."""
    s = np.array([1, 1, 1.5])
    for _ in range(200):
        s = controller.problem.step(s, controller.solve(s, elapsed=float(DT)).inputs[0])
        if clearance(s[None])[0] < 0:
            return False
        if distance(s[None])[0] < 0.3:
            return True
    return False


common = dict(horizon=40, samples=512, temperature=0.5)
mppi = succeeded(lambda seed: arrives(slalom.Mppi(robot, **common, variance=[2, 4], seed=seed)))
svg_mppi = succeeded(lambda seed: arrives(slalom.SvgMppi(
    robot, **common, guide_step=0.25, guide_variance=[0.5, 1], gradient_variance=[0.5, 1], gradient_temperature=0.5,
    restart_variance=[1, 2], variance_min=[0.25, 0.5], variance_max=[2, 4], seed=seed)))
report("the robot arrives", mppi, svg_mppi, 18)
