"""Programs of others, from the folder that SLALOM_PEERS_DIR names: one clone for each of their repositories."""

import os
import re
import sys
from pathlib import Path

CLONES = "pytorch_mppi", "arm_pytorch_utilities", "pytorch_seed"  # the last two are what the first imports


def folder():
    """The folder with the clones, or None if SLALOM_PEERS_DIR is not set. A folder without one of them is an error."""
    if not os.environ.get("SLALOM_PEERS_DIR"):
        return None
    peers = Path(os.environ["SLALOM_PEERS_DIR"])
    for name in CLONES:
        if not (peers / name / "src" / name).is_dir():
            raise FileNotFoundError(f"SLALOM_PEERS_DIR: {peers} has no clone of {name} "
                                    f"(github.com/UM-ARM-Lab/{name}): {peers / name / 'src' / name} is missing")
    return peers


def pytorch_mppi_version():
    """The version of the clone, or None."""
    peers = folder()
    if not peers:
        return None
    return re.search(r'^version *= *"([^"]+)"', (peers / "pytorch_mppi/pyproject.toml").read_text(), re.M)[1]


class PytorchMppi:
    """pytorch_mppi.MPPI with the problem, samples, horizon, noise and temperature of the loops in batched_mppi.py.

    pytorch_mppi counts the cost of a step after the step, in the state that it leads to. So that it minimises the same
    sum as the others, the cost is evaluated in the state before the step. The plan starts at zero, as that of the
    others; by default it would start at random inputs.
    """

    def __init__(self, problem, horizon, samples, temperature, variance, low, high, seed):
        for name in CLONES:
            source = str(folder() / name / "src")
            if source not in sys.path:
                sys.path.append(source)
        import torch
        from pytorch_mppi import MPPI

        def dynamics(x, u):
            self.before = x
            return problem.dynamics(x, u)

        self.torch = torch
        torch.manual_seed(seed)  # pytorch_mppi draws from torch's own generator
        self.mppi = MPPI(
            dynamics, lambda _, u: problem.cost(self.before, u), nx=len(problem.start), horizon=horizon,
            num_samples=samples, lambda_=temperature, noise_sigma=torch.diag(torch.tensor(variance)),
            u_min=torch.tensor(low), u_max=torch.tensor(high), U_init=torch.zeros(horizon, len(variance)),
            terminal_state_cost=lambda states, _: problem.terminal_cost(states[0, :, -1])[None])

    def solve(self, state):
        with self.torch.no_grad():
            self.mppi.command(self.torch.tensor(state, dtype=self.torch.float32))
        return self.mppi.get_action_sequence().numpy()
