"""A robot with two driven wheels and a disc in its way. Left and right are equally good; their average collides."""

import numpy as np
import slalom
from seeds import report, succeeded

robot = slalom.DifferentialDrive()


def arrives(controller):
    """Whether the robot reaches its goal within 12 s without a collision."""
    x = np.zeros(3)
    for _ in range(120):
        x = robot.step(x, controller.solve(x, elapsed=robot.dt).inputs[0])
        if robot.collides(x):
            return False
        if np.hypot(x[0] - robot.goal_x, x[1] - robot.goal_y) < 0.3:
            return True
    return False


for temperature in 0.3, 3.0:
    common = dict(horizon=25, temperature=temperature, input_min=[0, -2], input_max=[1.5, 2])
    mppi = succeeded(lambda seed: arrives(slalom.Mppi(robot, **common, variance=[0.4, 1.6], seed=seed)))
    svg_mppi = succeeded(lambda seed: arrives(slalom.SvgMppi(
        robot, **common, guide_step=[0.1, 0.4], guide_variance=[0.2, 0.8], gradient_variance=[0.2, 0.8],
        gradient_temperature=temperature, variance_min=[0.04, 0.16], variance_max=[0.4, 1.6], seed=seed)))
    report(f"temperature {temperature:g}, the robot arrives", mppi, svg_mppi, 20, compare=True)
