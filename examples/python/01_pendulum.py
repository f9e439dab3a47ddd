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


def stands(method, seed):
    """Whether the pendulum is upright 6 s after it started hanging down."""
    controller = method(pendulum, horizon=60, samples=1024, input_min=-5, input_max=5, seed=seed)
    angle, rate = slalom.run(pendulum, controller, [np.pi, 0], steps=300).states[-1]
    return np.cos(angle) > 0.995 and abs(rate) < 0.5


mppi, svg_mppi = (succeeded(method.__name__, lambda seed: stands(method, seed)) for method in (slalom.Mppi, slalom.SvgMppi))
report("the pendulum is upright", mppi, svg_mppi, 20)
