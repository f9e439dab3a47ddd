"""The time of a solve beyond that of the problem's callables: K = 1000 samples, T = 30 steps."""

import time

import numpy as np
import slalom

K, T, REPEATS = 1000, 30, 300
DT = np.float32(0.02)


def dynamics(x, u):
    angle, rate = x.T
    rate = rate + DT * (np.float32(9.81) * np.sin(angle) + u[:, 0])
    return np.stack([angle + DT * rate, rate]).T


def cost(x, u):
    angle, rate = x.T
    return DT * (10 * (1 - np.cos(angle)) + np.float32(0.1) * rate**2 + np.float32(0.01) * u[:, 0] ** 2)


def alone(inputs):
    """The callables in a plain loop."""
    x = np.zeros((2, K), np.float32).T
    start = time.perf_counter()
    for k in range(T):
        cost(x, inputs[k])
        x = dynamics(x, inputs[k])
    return time.perf_counter() - start


controller = slalom.Mppi(slalom.Problem(dynamics, cost, states=2, inputs=1, dt=0.02), horizon=T, samples=K)
inputs = np.random.default_rng(0).standard_normal((T, K, 1), dtype=np.float32)
bare, solves = [], []
for _ in range(REPEATS):  # alternately, so that both are measured under the same conditions
    bare.append(alone(inputs))
    start = time.perf_counter()
    controller.solve([3.0, 0.0])
    solves.append(time.perf_counter() - start)
a, b = 1e3 * np.median(bare), 1e3 * np.median(solves)
print(f"callables alone {a:.3f} ms, solve {b:.3f} ms (median of {REPEATS}): {100 * (b / a - 1):.1f} % more")
