"""The loops of docs/comparison.md compute the same as `mppi`: the same samples give the same plan."""

import os
import sys
from pathlib import Path

import numpy as np
import pytest
import slalom

sys.path.append(str(Path(__file__).resolve().parents[3] / "bench" / "peers"))

import peers  # noqa: E402
from batched_mppi import NumpyMppi, TorchMppi  # noqa: E402
from problems import CartPole, DoubleIntegrator, Obstacles, Pendulum, Quadrotor  # noqa: E402

SAMPLES, HORIZON = 208, 12  # a multiple of 16, to which a batch of samples is padded
KINDS = [Pendulum, DoubleIntegrator, Obstacles, CartPole, Quadrotor]


def settings(p):
    return HORIZON, SAMPLES, p.temperature, p.variance, p.low, p.high, 1


def nominal(p):
    """A plan that is not zero, so that the control term counts."""
    return np.tile(0.3 * np.array(p.high, np.float32), (HORIZON, 1))


def noise(p):
    """Standard normal values [samples, horizon, inputs]."""
    return np.random.default_rng(5).standard_normal((SAMPLES, HORIZON, len(p.variance)), np.float32)


class Fixed:
    """A generator that draws the same values in every solve."""

    def __init__(self, values):
        self.values = values

    def standard_normal(self, shape, dtype):
        assert self.values.shape == shape
        return self.values.astype(dtype)


def numpy_plan(p):
    loop = NumpyMppi(p, *settings(p))
    loop.mean, loop.random = nominal(p), Fixed(noise(p))
    return loop.solve(p.start)


@pytest.mark.parametrize("kind", KINDS)
def test_mppi_on_the_same_samples_plans_as_the_loop_on_numpy(kind):
    p = kind(np)
    problem = slalom.Problem(p.dynamics, p.cost, p.terminal_cost, states=len(p.start), inputs=len(p.variance), dt=p.dt,
                             sampler=lambda *_: noise(p))
    mppi = slalom.Mppi(problem, horizon=HORIZON, samples=SAMPLES, temperature=p.temperature, variance=p.variance,
                       control_cost_discount=0, input_min=p.low, input_max=p.high)
    first = mppi.solve(p.start, elapsed=p.dt).inputs.copy()
    loop = NumpyMppi(p, *settings(p))
    loop.random = Fixed(noise(p))
    np.testing.assert_allclose(first, loop.solve(p.start), atol=2e-3)
    second = mppi.solve(p.start, elapsed=p.dt).inputs  # from a plan that is not zero, so the control term counts
    np.testing.assert_allclose(second, loop.solve(p.start), atol=2e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_the_loop_on_torch_plans_as_that_on_numpy(kind, monkeypatch):
    torch = pytest.importorskip("torch")
    p = kind(np)
    loop = TorchMppi(kind(torch), *settings(p))
    loop.mean = torch.tensor(nominal(p))
    monkeypatch.setattr(torch, "randn", lambda *shape, generator: torch.tensor(noise(p)))
    np.testing.assert_allclose(loop.solve(p.start), numpy_plan(p), atol=2e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_pytorch_mppi_plans_as_the_loop_on_numpy(kind):
    torch = pytest.importorskip("torch")
    if not os.environ.get("SLALOM_PEERS_DIR"):
        pytest.skip("SLALOM_PEERS_DIR is not set")
    p = kind(np)
    peer = peers.PytorchMppi(kind(torch), *settings(p))
    peer.mppi.U = torch.tensor(nominal(p))
    peer.mppi.u_init = torch.tensor(nominal(p)[0])  # it ends a plan with this input, the loops with the last one
    peer.mppi._sample_noise = lambda _: torch.tensor(noise(p)) * torch.tensor(p.variance).sqrt()
    np.testing.assert_allclose(peer.solve(p.start), numpy_plan(p), atol=2e-3)


def test_a_folder_of_peers_without_a_clone_is_an_error_that_names_it(tmp_path, monkeypatch):
    monkeypatch.setenv("SLALOM_PEERS_DIR", str(tmp_path))
    with pytest.raises(FileNotFoundError, match="no clone of pytorch_mppi"):
        peers.pytorch_mppi_version()
    monkeypatch.delenv("SLALOM_PEERS_DIR")
    assert peers.pytorch_mppi_version() is None
