"""A mass point follows a goal that goes to and fro behind a disc, as numpy callables.

The goal is a part of the state: rollouts know where it will be if it keeps its speed, and every solve starts from where it
is.
"""

import numpy as np
import slalom
from seeds import report, succeeded

DT, RADIUS = np.float32(0.1), np.float32(0.8)  # s; m, of the disc at the origin


def dynamics(s, u):  # states: position, speed, position and speed of the goal, each x and y; inputs: m/s^2
    x, y, speed_x, speed_y, goal_x, goal_y, goal_speed_x, goal_speed_y = s.T
    speed_x, speed_y = speed_x + DT * u[:, 0], speed_y + DT * u[:, 1]
    return np.stack([x + DT * speed_x, y + DT * speed_y, speed_x, speed_y, goal_x + DT * goal_speed_x,
                     goal_y + DT * goal_speed_y, goal_speed_x, goal_speed_y]).T


def distance(s):
    return np.hypot(s[:, 0] - s[:, 4], s[:, 1] - s[:, 5])


def collides(s):
    return np.hypot(s[:, 0], s[:, 1]) < RADIUS


def cost(s, u):
    hit = collides(s)
    return DT * (4 * distance(s) + np.float32(0.02) * np.sum(u**2, axis=1)) + np.float32(100) * hit, hit


def terminal_cost(s):
    return np.float32(0.1) * (s[:, 2] ** 2 + s[:, 3] ** 2)


chase = slalom.Problem(dynamics, cost, terminal_cost, states=8, inputs=2, dt=float(DT), input_min=-4, input_max=4)


def goal(time):
    """Where the goal is, and how it moves: to and fro in 8 s, on both sides of the disc."""
    turning = 2 * np.pi / 8  # rad/s
    cosine, sine = np.cos(turning * time), np.sin(turning * time)
    return 2.2 * cosine, 0.2 * sine, -2.2 * turning * sine, 0.2 * turning * cosine


def follows(controller):
    """Whether it is within 0.5 m of the goal, 0.5 s after each of its turns, and never hits the disc in 16 s."""
    s = np.array([2, 0, 0, 0, 0, 0, 0, 0.0])
    for k in range(1, 161):
        s = np.array([*s[:4], *goal((k - 1) * float(DT))])
        s = controller.problem.step(s, controller.solve(s, elapsed=float(DT)).inputs[0])
        if collides(s[None])[0] or (k % 40 == 5 and distance(s[None])[0] > 0.5):
            return False
    return True


common = dict(horizon=25, temperature=1)
mppi = succeeded(lambda seed: follows(slalom.Mppi(chase, **common, samples=1024, variance=2.25, seed=seed)))
svg_mppi = succeeded(lambda seed: follows(slalom.SvgMppi(
    chase, **common, samples=512, guides=4, guide_step=0.56, guide_variance=1.12, gradient_samples=12,
    gradient_variance=1.12, restart_variance=2.25, variance_min=0.56, variance_max=2.25, seed=seed)))
report("the point follows the goal", mppi, svg_mppi, 18, compare=True)
