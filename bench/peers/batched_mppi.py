"""MPPI on batched callables, as short as one writes it oneself: a yardstick, not a copy of anybody's program.

The update is that of Williams et al. (T-RO 2018), as in slalom's `mppi`: samples v = u + e, e ~ N(0, Sigma), cut at
the bounds; weights softmax(-(S(v) + lambda sum u^T Sigma^-1 v) / lambda); u = weighted mean of v.
"""

import numpy as np


class NumpyMppi:
    """Callables on numpy arrays: dynamics(x[K, nx], u[K, nu]) -> x, cost(x, u) -> [K], terminal_cost(x) -> [K]."""

    def __init__(self, problem, horizon, samples, temperature, variance, low, high, seed):
        self.problem, self.temperature = problem, temperature
        self.low, self.high = np.float32(low), np.float32(high)
        self.deviation = np.sqrt(np.float32(variance))
        self.mean = np.zeros((horizon, len(variance)), np.float32)
        self.samples, self.random = samples, np.random.default_rng(seed)

    def solve(self, state):
        self.mean = np.concatenate([self.mean[1:], self.mean[-1:]])
        noise = self.random.standard_normal((self.samples, *self.mean.shape), np.float32)
        plans = np.clip(self.mean + self.deviation * noise, self.low, self.high)
        x = np.repeat(np.float32(state)[None], self.samples, axis=0)
        total = np.zeros(self.samples, np.float32)
        for k in range(len(self.mean)):
            total += self.problem.cost(x, plans[:, k])
            x = self.problem.dynamics(x, plans[:, k])
        total += self.problem.terminal_cost(x)
        total += self.temperature * np.sum(self.mean / self.deviation**2 * plans, axis=(1, 2))
        weights = np.exp((total.min() - total) / self.temperature)
        self.mean = np.tensordot(weights / weights.sum(), plans, 1)
        return self.mean


class TorchMppi:
    """The same on torch tensors."""

    def __init__(self, problem, horizon, samples, temperature, variance, low, high, seed):
        import torch

        self.torch, self.problem, self.temperature, self.samples = torch, problem, temperature, samples
        self.low, self.high = torch.tensor(low, dtype=torch.float32), torch.tensor(high, dtype=torch.float32)
        self.deviation = torch.tensor(variance, dtype=torch.float32).sqrt()
        self.mean = torch.zeros(horizon, len(variance))
        self.random = torch.Generator().manual_seed(seed)

    def solve(self, state):
        torch = self.torch
        with torch.no_grad():
            self.mean = torch.cat([self.mean[1:], self.mean[-1:]])
            noise = torch.randn(self.samples, *self.mean.shape, generator=self.random)
            plans = torch.maximum(torch.minimum(self.mean + self.deviation * noise, self.high), self.low)
            x = torch.tensor(state, dtype=torch.float32).repeat(self.samples, 1)
            total = torch.zeros(self.samples)
            for k in range(len(self.mean)):
                total += self.problem.cost(x, plans[:, k])
                x = self.problem.dynamics(x, plans[:, k])
            total += self.problem.terminal_cost(x)
            total += self.temperature * (self.mean / self.deviation**2 * plans).sum(dim=(1, 2))
            weights = torch.softmax(-total / self.temperature, 0)
            self.mean = torch.tensordot(weights, plans, 1)
            return self.mean.numpy()
