"""A hovercraft flies through the gap between two discs, as numpy callables."""

import numpy as np
import slalom
from seeds import report, succeeded

DT, DRAG = np.float32(0.05), np.float32(0.2)  # s, 1/s
GOAL_X, DISC_X, DISC_Y, CLEARANCE = map(np.float32, (6, 3, 0.9, 0.65))  # m; the second disc is at -DISC_Y


def dynamics(s, u):  # inputs: m/s^2 ahead, m/s^2 to the left, rad/s^2
    x, y, yaw, speed_x, speed_y, rate = s.T
    sine, cosine = np.sin(yaw), np.cos(yaw)
    speed_x = speed_x + DT * (cosine * u[:, 0] - sine * u[:, 1] - DRAG * speed_x)
    speed_y = speed_y + DT * (sine * u[:, 0] + cosine * u[:, 1] - DRAG * speed_y)
    rate = rate + DT * (u[:, 2] - DRAG * rate)
    return np.stack([x + DT * speed_x, y + DT * speed_y, yaw + DT * rate, speed_x, speed_y, rate]).T


def distance(s):
    return np.hypot(s[:, 0] - GOAL_X, s[:, 1])


def collides(s):
    return np.hypot(s[:, 0] - DISC_X, np.abs(s[:, 1]) - DISC_Y) < CLEARANCE


def cost(s, u):
    hit = collides(s)
    return DT * (distance(s) + np.float32(0.01) * np.sum(u**2, axis=1)) + np.float32(100) * hit, hit


def terminal_cost(s):
    return 5 * distance(s) + s[:, 3] ** 2 + s[:, 4] ** 2 + np.float32(0.2) * s[:, 5] ** 2


craft = slalom.Problem(dynamics, cost, terminal_cost, states=6, inputs=3, dt=float(DT), input_min=-3, input_max=3)


def arrives(controller):
    """Whether it is within 0.3 m of its goal after 6 s, without a collision and with plans of several samples."""
    s, few = np.array([0, 0.5, 0, 0, 0, 0]), False
    for _ in range(120):
        plan = controller.solve(s, elapsed=float(DT))
        few = few or plan.has_few_samples
        s = controller.problem.step(s, plan.inputs[0])
        if collides(s[None])[0]:
            return False
    return distance(s[None])[0] < 0.3 and not few


common = dict(horizon=40, samples=512, temperature=1)
mppi = succeeded(lambda seed: arrives(slalom.Mppi(craft, **common, variance=2.25, seed=seed)))
svg_mppi = succeeded(lambda seed: arrives(slalom.SvgMppi(
    craft, **common, guide_step=0.56, guide_variance=1.12, gradient_variance=1.12, restart_variance=2.25,
    variance_min=0.56, variance_max=2.25, seed=seed)))
report("the hovercraft arrives", mppi, svg_mppi, 18)
