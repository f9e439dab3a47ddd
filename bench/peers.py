"""Slalom beside others on environments of gymnasium: the table of docs/comparison.md.

usage: PYTHONPATH=build/release/adapters/python python3 bench/peers.py [seeds]

Needs gymnasium[mujoco]; rows of pytorch_mppi need that package. Times are the processor's. Lines are those of the functions
that make a planner of an environment.
"""

import importlib.util
import inspect
import sys
import time

import gymnasium
import numpy as np
import slalom.gymnasium

# Steps of the horizon and, at most, of an episode.
STEPS = {"Pendulum-v1": (20, 200), "MountainCarContinuous-v0": (100, 999), "Reacher-v5": (15, 50), "Hopper-v5": (30, 1000),
         "HalfCheetah-v5": (20, 1000)}
SEEDS = int(sys.argv[1]) if len(sys.argv) > 1 else 10


def environment(env, seed):
    problem = slalom.gymnasium.Problem(env)
    return slalom.SvgMppi(problem, horizon=STEPS[env.spec.id][0], samples=64, seed=seed).command


def pendulum(m):
    def dynamics(x, u):
        rate = m.clip(x[:, 1] + 0.05 * (15 * m.sin(x[:, 0]) + 3 * u[:, 0]), -8, 8)
        return m.stack([x[:, 0] + 0.05 * rate, rate], 1)

    def cost(x, u):
        angle = (x[:, 0] + m.pi) % (2 * m.pi) - m.pi
        return angle**2 + 0.1 * x[:, 1] ** 2 + 0.001 * u[:, 0] ** 2

    return dynamics, cost


def callables(env, seed):
    problem = slalom.Problem(*pendulum(np), states=2, inputs=1, dt=0.05, input_min=-2, input_max=2)
    return slalom.Mppi(problem, horizon=20, samples=1000, seed=seed).command


def pytorch_mppi(env, seed):
    import torch
    from pytorch_mppi import MPPI

    torch.manual_seed(seed)
    mppi = MPPI(*pendulum(torch), nx=2, noise_sigma=torch.eye(1), num_samples=1000, horizon=20, lambda_=1.0,
                u_min=torch.tensor([-2.0]), u_max=torch.tensor([2.0]))
    return lambda x: mppi.command(torch.tensor(x, dtype=torch.float32)).numpy()


def drive(env, command, seed):
    """The return of an episode, and the processor times of the commands, s."""
    total, times, ends = 0.0, [], False
    env.reset(seed=seed)
    while len(times) < STEPS[env.spec.id][1] and not ends:
        begin = time.process_time()
        action = np.asarray(command(slalom.gymnasium.state_of(env)), env.action_space.dtype)
        times.append(time.process_time() - begin)
        _, reward, *over, _ = env.step(action)
        total, ends = total + float(reward), any(over)
    return total, times


def main():
    ways = {"slalom `svg_mppi`, the environment": environment, "slalom `mppi`, numpy callables": callables,
            "pytorch_mppi": pytorch_mppi}
    print("| environment | planner | return: mean, deviation, least | a solve, ms (p50) | lines |\n|---|---|---|---|---|")
    for name, (_, steps) in STEPS.items():
        for way, make in list(ways.items())[:3 if name == "Pendulum-v1" else 1]:
            if make is pytorch_mppi and not importlib.util.find_spec("pytorch_mppi"):
                continue  # not installed
            env = gymnasium.make(name)
            runs = [drive(env, make(env, seed), seed) for seed in range(SEEDS)]
            returns, lines = [round(total, 1) for total, _ in runs], sum(
                len(inspect.getsource(each).splitlines()) for each in [make] + [pendulum] * (make in (callables, pytorch_mppi)))
            print(f"| {name}, {steps} steps | {way} | {np.mean(returns):.1f} +- {np.std(returns):.1f}, {min(returns)} "
                  f"| {1e3 * np.median(np.concatenate([times for _, times in runs])):.1f} | {lines + 2} |", flush=True)


if __name__ == "__main__":
    main()
