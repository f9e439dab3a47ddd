"""The problems, written once for numpy and torch: `m` is either module."""

import numpy as np


class Pendulum:
    """A pendulum whose motor is too weak to lift it; state angle from upright, rate."""

    name, start, steps, dt = "pendulum", [np.pi, 0.0], 150, 0.04
    variance, low, high, temperature = [4.0], [-5.0], [5.0], 0.2

    def __init__(self, m):
        self.m = m

    def dynamics(self, x, u):
        rate = x[:, 1] + self.dt * (9.81 * self.m.sin(x[:, 0]) + u[:, 0])
        return self.m.stack([x[:, 0] + self.dt * rate, rate], 1)

    def cost(self, x, u):
        return self.dt * (10 * (1 - self.m.cos(x[:, 0])) + 0.1 * x[:, 1] ** 2 + 0.01 * u[:, 0] ** 2)

    def terminal_cost(self, x):
        return (0.5 * x[:, 1] ** 2 + 9.81 * (self.m.cos(x[:, 0]) - 1)) ** 2


class DoubleIntegrator:
    """A point in the plane that is to stop at the origin; inputs are accelerations; state x, y and their speeds."""

    name, start, steps, dt = "double integrator", [2.0, -1.0, 0.0, 0.0], 80, 0.1
    variance, low, high, temperature = [1.0, 1.0], [-2.0, -2.0], [2.0, 2.0], 0.3

    def __init__(self, m):
        self.m = m

    def dynamics(self, x, u):
        parts = [x[:, :2] + self.dt * x[:, 2:], x[:, 2:] + self.dt * u]
        return self.m.concatenate(parts, 1) if self.m is np else self.m.cat(parts, 1)

    def cost(self, x, u):
        return (x[:, :2] ** 2).sum(1) + 0.5 * (x[:, 2:] ** 2).sum(1) + 0.01 * (u**2).sum(1)

    def terminal_cost(self, x):
        return 10 * (x[:, :2] ** 2).sum(1) + (x[:, 2:] ** 2).sum(1)


class Obstacles:
    """A robot with two driven wheels among three discs; state x, y, yaw."""

    name, start, steps, dt = "obstacles", [0.0, 0.0, 0.0], 80, 0.1
    variance, low, high, temperature = [0.4, 1.6], [0.0, -2.0], [1.5, 2.0], 0.3
    goal, discs = (8.0, 0.0), ((2.5, 0.0, 0.9), (5.2, 1.0, 0.7), (5.2, -1.0, 0.7))

    def __init__(self, m):
        self.m = m

    def dynamics(self, x, u):
        c, s = self.m.cos(x[:, 2]), self.m.sin(x[:, 2])
        way = self.dt * u[:, 0]
        return self.m.stack([x[:, 0] + way * c, x[:, 1] + way * s, x[:, 2] + self.dt * u[:, 1]], 1)

    def distance(self, x):
        return self.m.sqrt((x[:, 0] - self.goal[0]) ** 2 + (x[:, 1] - self.goal[1]) ** 2)

    def place(self, x):
        total = self.distance(x)
        hit = x[:, 0] != x[:, 0]
        for a, b, radius in self.discs:
            hit = hit | ((x[:, 0] - a) ** 2 + (x[:, 1] - b) ** 2 < radius**2)
        return total + 100.0 * hit

    def cost(self, x, u):
        return self.place(x) + 0.1 * u[:, 1] ** 2

    def terminal_cost(self, x):
        return self.place(x) + 5 * self.distance(x)
