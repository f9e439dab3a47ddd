"""The same problems, samples, horizon, noise and temperature: solve times and closed-loop costs, on one core.

Times are the processor's, so that neighbours count little.

usage: PYTHONPATH=build/release/adapters/python taskset -c 1 python3 bench/peers/compare.py [seeds]

Needs numpy. With torch (Debian: python3-torch) there is a row for a loop on torch; if SLALOM_PEERS_DIR names a folder with
clones of pytorch_mppi and of what it needs, there is one for pytorch_mppi itself.
"""

import os
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import slalom
from batched_mppi import NumpyMppi, TorchMppi
from peers import PytorchMppi, pytorch_mppi_version
from problems import CartPole, DoubleIntegrator, Obstacles, Pendulum, Quadrotor

try:
    import torch

    torch.set_num_threads(1)
except ImportError:
    torch = None

PEER = pytorch_mppi_version()
K, T = 1000, 30
SEEDS = int(sys.argv[1]) if len(sys.argv) > 1 else 10


def of_slalom(method, problem, p, seed, **options):
    controller = method(problem, horizon=T, samples=K, input_min=p.low, input_max=p.high, seed=seed, **options)
    return lambda x: controller.solve(x, elapsed=p.dt).inputs


def same_mppi(problem, p):
    """seed -> solve(x) of `mppi` with the noise, temperature and control term of the loops."""
    return lambda seed: of_slalom(slalom.Mppi, problem, p, seed, temperature=p.temperature, variance=p.variance,
                                  control_cost_discount=0)


def callables(p):
    return slalom.Problem(p.dynamics, p.cost, p.terminal_cost, states=len(p.start), inputs=len(p.variance), dt=p.dt)


def ways(Kind):
    """{name: seed -> solve(x)} of everything that solves a problem."""
    p = Kind(np)
    common = (T, K, p.temperature, p.variance, p.low, p.high)
    yield "batched numpy (this folder)", lambda seed: NumpyMppi(p, *common, seed).solve
    if torch:
        yield "batched torch (this folder)", lambda seed: TorchMppi(Kind(torch), *common, seed).solve
        if PEER:
            yield f"pytorch_mppi {PEER}", lambda seed: PytorchMppi(Kind(torch), *common, seed).solve
    yield "slalom `mppi`, numpy callables", same_mppi(callables(p), p)
    compiled = {"pendulum": slalom.Pendulum(dt=0.04), "obstacles": slalom.DifferentialDrive(),
                "cart-pole": slalom.CartPole(dt=0.04), "quadrotor": slalom.Quadrotor()}.get(p.name)
    if compiled:
        yield "slalom `mppi`, compiled problem", same_mppi(compiled, p)
    yield "slalom `svg_mppi`, defaults", lambda seed: of_slalom(slalom.SvgMppi, compiled or callables(p), p, seed)


def drive(p, solve):
    """The cost of the driven trajectory, and the solve times."""
    x, cost, times = np.array(p.start), 0.0, []
    for _ in range(p.steps):
        before = time.thread_time()
        inputs = solve(x)
        times.append(time.thread_time() - before)
        u = np.array(inputs[:1], float)
        cost += float(p.cost(x[None], u)[0])
        x = p.dynamics(x[None], u)[0]
    return cost, times


print(f"K = {K}, T = {T}, {SEEDS} seeds, one thread, numpy {np.__version__}, torch {torch and torch.__version__}, "
      f"pytorch_mppi {PEER or '(none: SLALOM_PEERS_DIR)'}\n")
print("| problem | solver | CPU time of a solve, ms (p50) | p99 | closed-loop cost (mean, standard error) |\n|---|---|---|---|---|")
for Kind in Pendulum, DoubleIntegrator, Obstacles, CartPole, Quadrotor:
    for name, make in ways(Kind):
        runs = [drive(Kind(np), make(seed)) for seed in range(SEEDS)]
        costs, times = [cost for cost, _ in runs], 1e3 * np.concatenate([t[3:] for _, t in runs])
        print(f"| {Kind.name} | {name} | {np.median(times):.3f} | {np.percentile(times, 99):.3f} "
              f"| {np.mean(costs):.2f}, {np.std(costs) / np.sqrt(len(costs)):.2f} |", flush=True)
