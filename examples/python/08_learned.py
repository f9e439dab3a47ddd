"""A boat holds its place in a river whose current and drag nobody has modelled: a network learns them from recorded trips.

With a second argument, writes the network to that file: examples/learned/boat.npz, which 08_learned.cpp reads.
"""

import sys

import numpy as np
import slalom
from seeds import SEEDS, succeeded
from slalom.mlp import train_mlp

DT = 0.1  # s
GOAL = np.array([0, 2.5])  # m, in the strongest current


def river(s, u):
    """The real boat: states x, y (m) and speeds (m/s); inputs accelerations (m/s^2)."""
    current = 1.2 * np.exp(-((s[:, 1] - 2.5) ** 2))  # m/s, along x, strongest in the middle
    relative = s[:, 2:] - np.stack([current, 0 * current]).T
    speed = np.hypot(*relative.T)[:, None]
    return move(s, s[:, 2:] + DT * (u - 0.6 * speed * relative))


def move(s, speeds):
    return np.concatenate([s[:, :2] + DT * speeds, speeds], axis=1)


def record(trips, steps, random):
    """Speeds before and after each step of trips with random inputs: inputs and outputs of the network."""
    before, after = [], []
    s = np.stack([np.zeros(trips), random.uniform(-1, 6, trips), *random.uniform(-1.5, 1.5, (2, trips))]).T
    for _ in range(steps):
        u = random.uniform(-2, 2, (trips, 2))
        following = river(s, u)
        before.append(np.concatenate([s[:, 2:], s[:, 1:2], u], axis=1))  # speeds first: the network is residual
        after.append(following[:, 2:])
        s = following
        s[:, 1] = np.clip(s[:, 1], -1, 6)
    return np.concatenate(before), np.concatenate(after)


print("training on 200 trips", flush=True)
network = train_mlp(*record(trips=200, steps=60, random=np.random.default_rng(0)), residual=True, epochs=100)
if len(sys.argv) > 2:
    network.save(sys.argv[2])
inputs, outputs = record(trips=20, steps=60, random=np.random.default_rng(1))
error = np.sqrt(np.mean((network(inputs) - outputs) ** 2))
change = np.sqrt(np.mean((inputs[:, :2] + DT * inputs[:, 3:] - outputs) ** 2))
print(f"error of a step on trips that it has not seen: network {error:.4f} m/s, model without water {change:.4f} m/s")


def learned(s, u):
    return move(s, network(np.concatenate([s[:, 2:], s[:, 1:2], u], axis=1)))


def without_water(s, u):
    return move(s, s[:, 2:] + np.float32(DT) * u)


def cost(s, u):
    return DT * (s[:, 0] ** 2 + (s[:, 1] - GOAL[1]) ** 2 + 0.2 * np.sum(s[:, 2:] ** 2, axis=1)
                 + 0.02 * np.sum(u**2, axis=1))


def holds(dynamics, seed):
    """Whether the boat is within 0.3 m of its goal during the last 2 of 8 s."""
    problem = slalom.Problem(dynamics, cost, lambda s: 2 * np.sum((s[:, :2] - GOAL) ** 2, axis=1), states=4, inputs=2,
                             dt=DT, input_min=-2, input_max=2)
    controller = slalom.Mppi(problem, horizon=20, samples=256, temperature=0.1, variance=1, seed=seed)
    drive = slalom.run(problem, controller, np.zeros(4), 80, plant=lambda s, u: river(s[None], u[None])[0])
    return np.hypot(*(drive.states[-20:, :2] - GOAL).T).max() < 0.3


without, with_network = (succeeded(f.__name__, lambda seed: holds(f, seed)) for f in (without_water, learned))
print(f"the boat holds its place: without a model of the water {without} of {SEEDS} seeds, with the network {with_network}")
assert error < 0.2 * change and with_network >= 0.9 * SEEDS and with_network > without
