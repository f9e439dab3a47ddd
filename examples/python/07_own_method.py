"""A method of your own for the same problems: predictive sampling chooses the best of many perturbed plans."""

import numpy as np
import slalom


class PredictiveSampling:
    def __init__(self, dynamics, cost, horizon, inputs, samples=512, deviation=0.5, seed=0):
        self.dynamics, self.cost = dynamics, cost
        self.samples, self.deviation = samples, deviation
        self.plan = np.zeros((horizon, inputs))
        self.random = np.random.default_rng(seed)

    def solve(self, state):
        plans = np.roll(self.plan, -1, axis=0) + self.deviation * self.random.standard_normal(
            (self.samples, *self.plan.shape))
        plans[0] = np.roll(self.plan, -1, axis=0)
        x, total = np.tile(state, (self.samples, 1)), np.zeros(self.samples)
        for k in range(plans.shape[1]):
            total += self.cost(x, plans[:, k])
            x = self.dynamics(x, plans[:, k])
        self.plan = plans[np.argmin(total)]
        return self.plan


def dynamics(x, u):  # a point in the plane: x, y (m), their speeds (m/s)
    return np.concatenate([x[:, :2] + 0.1 * x[:, 2:], x[:, 2:] + 0.1 * u], axis=1)


def cost(x, u):
    return np.sum(x[:, :2] ** 2, axis=1) + 0.5 * np.sum(x[:, 2:] ** 2, axis=1) + 0.01 * np.sum(u**2, axis=1)


def rest(solve, start=(2, -1, 0, 0)):
    x = np.array(start, float)
    for _ in range(100):
        x = dynamics(x[None], solve(x)[:1])[0]
    return np.hypot(*x[:2]) < 0.15


own = sum(rest(PredictiveSampling(dynamics, cost, 20, 2, seed=seed).solve) for seed in range(20))
point = slalom.Problem(dynamics, cost, states=4, inputs=2, dt=0.1)
mppi = slalom.Mppi(point, horizon=20, samples=512, temperature=0.3)
assert rest(lambda x: mppi.solve(x, elapsed=0.1).inputs)
print(f"the point comes to rest: predictive_sampling {own} of 20 seeds")
assert own == 20
