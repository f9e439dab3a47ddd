"""A quadrotor in the plane, a wall with two gaps: fly through one of them and hover behind it."""

import numpy as np
import slalom
from seeds import report, succeeded

quadrotor = slalom.Quadrotor()


def hits_wall(x):
    in_wall = quadrotor.wall_from < x[0] < quadrotor.wall_to
    return in_wall and abs(abs(x[1]) - quadrotor.gap_centre) > quadrotor.gap_width / 2


def arrives(controller):
    """Whether the quadrotor hovers within 1 m of its goal after 8 s and never collided with the wall."""
    x = np.zeros(6)
    for _ in range(160):
        x = quadrotor.step(x, controller.solve(x, elapsed=quadrotor.dt).inputs[0])
        if hits_wall(x):
            return False
    return np.hypot(x[0] - quadrotor.goal_x, x[1] - quadrotor.goal_z) < 1


for temperature in 0.3, 1.0:
    common = dict(horizon=40, samples=2048, temperature=temperature, input_min=[-6, -20], input_max=[6, 20])
    mppi = succeeded(lambda seed: arrives(slalom.Mppi(quadrotor, **common, variance=[2, 8], seed=seed)))
    svg_mppi = succeeded(lambda seed: arrives(slalom.SvgMppi(
        quadrotor, **common, guide_step=[0.5, 2], guide_variance=[1, 4], gradient_variance=[1, 4],
        gradient_temperature=temperature, variance_min=[0.5, 2], variance_max=[2, 8], seed=seed)))
    report(f"temperature {temperature:g}, the quadrotor hovers behind the wall", mppi, svg_mppi, 19, compare=True)
