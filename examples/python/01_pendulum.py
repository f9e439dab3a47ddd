"""A pendulum whose motor is too weak to lift it directly, as numpy callables: it must swing up."""

import numpy as np
import slalom
from seeds import report, succeeded

DT = np.float32(0.02)  # s; the angle is measured from upright


def dynamics(x, u):
    angle, rate = x.T
    rate = rate + DT * (np.float32(9.81) * np.sin(angle) + u[:, 0])
    return np.stack([angle + DT * rate, rate]).T


def cost(x, u):
    angle, rate = x.T
    return DT * (10 * (1 - np.cos(angle)) + np.float32(0.1) * rate**2 + np.float32(0.01) * u[:, 0] ** 2)


def terminal_cost(x):
    angle, rate = x.T
    return (rate**2 / 2 + np.float32(9.81) * (np.cos(angle) - 1)) ** 2  # missing energy, squared


pendulum = slalom.Problem(dynamics, cost, terminal_cost, states=2, inputs=1, dt=float(DT))


def stands(controller):
    """Whether the pendulum is upright 6 s after it started hanging down."""
    x = np.array([np.pi, 0.0])
    for _ in range(300):
        x = controller.problem.step(x, controller.solve(x, elapsed=float(DT)).inputs[0])
    return np.cos(x[0]) > 0.995 and abs(x[1]) < 0.5


common = dict(horizon=60, samples=1024, temperature=0.2, input_min=-5, input_max=5)
mppi = succeeded("mppi", lambda seed: stands(slalom.Mppi(pendulum, **common, variance=4, seed=seed)))
svg_mppi = succeeded("svg_mppi", lambda seed: stands(slalom.SvgMppi(
    pendulum, **common, gradient_variance=1, variance_min=1, variance_max=4, seed=seed)))
report("the pendulum is upright", mppi, svg_mppi, 20)
