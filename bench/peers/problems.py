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


class CartPole:
    """A pole on a cart: hanging, it has to be swung up within the track; state position, speed, angle from upright, rate."""

    name, start, steps, dt = "cart-pole", [0.0, 0.0, np.pi, 0.0], 125, 0.04
    variance, low, high, temperature = [25.0], [-10.0], [10.0], 0.1

    def __init__(self, m):
        self.m = m

    def dynamics(self, x, u):
        s, c = self.m.sin(x[:, 2]), self.m.cos(x[:, 2])
        push = (u[:, 0] + 0.1 * x[:, 3] ** 2 * s) / 1.2
        turn = (9.81 * s - c * push) / (0.6667 - 0.0833 * c * c)
        speed, rate = x[:, 1] + self.dt * (push - 0.0833 * turn * c), x[:, 3] + self.dt * turn
        return self.m.stack([x[:, 0] + self.dt * speed, speed, x[:, 2] + self.dt * rate, rate], 1)

    def cost(self, x, u):
        each = self.terminal_cost(x) + 0.1 * x[:, 1] ** 2 + 0.001 * u[:, 0] ** 2
        return self.dt * each + 100.0 * (abs(x[:, 0]) > 2)

    def terminal_cost(self, x):
        return 10 * (1 - self.m.cos(x[:, 2])) + x[:, 0] ** 2 + 0.1 * x[:, 3] ** 2


class Quadrotor:
    """A quadrotor in the vertical plane, and a wall with two gaps; state x, z, tilt and their speeds."""

    name, start, steps, dt = "quadrotor", [0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 120, 0.05
    variance, low, high, temperature = [4.0, 16.0], [-6.0, -10.0], [6.0, 10.0], 0.3

    def __init__(self, m):
        self.m = m

    def dynamics(self, x, u):
        thrust = 9.81 + u[:, 0]
        speed_x = x[:, 3] + self.dt * thrust * self.m.sin(x[:, 2])
        speed_z = x[:, 4] + self.dt * (thrust * self.m.cos(x[:, 2]) - 9.81)
        rate = x[:, 5] + self.dt * u[:, 1]
        speeds = speed_x, speed_z, rate
        return self.m.stack([*(x[:, i] + self.dt * v for i, v in enumerate(speeds)), *speeds], 1)

    def distance(self, x):
        return self.m.sqrt((x[:, 0] - 6) ** 2 + x[:, 1] ** 2)

    def square_speed(self, x):
        return x[:, 3] ** 2 + x[:, 4] ** 2 + x[:, 2] ** 2 + 0.2 * x[:, 5] ** 2

    def cost(self, x, u):
        hit = (x[:, 0] > 2.8) & (x[:, 0] < 3.2) & (abs(abs(x[:, 1]) - 1) > 0.5)
        effort = 0.01 * (u**2).sum(1)
        return self.dt * (self.distance(x) + 0.2 * self.square_speed(x) + effort) + 100.0 * hit

    def terminal_cost(self, x):
        return 3 * self.distance(x) + 0.3 * self.square_speed(x)
