"""The example that writes SVG-MPPI in numpy, against the figures with which the C++ solver is compared."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]
specification = importlib.util.spec_from_file_location("svg_mppi_example", ROOT / "examples/python/svg_mppi.py")
example = importlib.util.module_from_spec(specification)
specification.loader.exec_module(example)


def cost(V):
    """That of tests/solvers/methods/reference_test.cpp."""
    x, y, speed_x, speed_y, total = 1.5, 0.2, -0.5, 0.0, 0.0
    for u in np.moveaxis(V, 1, 0):
        total = total + x * x + y * y + 0.05 * (u**2).sum(axis=1) + 3 * np.exp(-4 * ((x - 0.7) ** 2 + y * y))
        x, y = x + 0.2 * speed_x, y + 0.2 * speed_y
        speed_x, speed_y = speed_x + 0.2 * u[:, 0], speed_y + 0.2 * u[:, 1]
    return total + 5 * (x * x + y * y)


def test_has_the_recorded_figures():
    record = json.loads((ROOT / "tests/reference/svg_mppi.json").read_text())
    settings = {name: record[name] for name in ("K", "L", "N", "epsilon", "Sigma_g", "Sigma_0", "Sigma_min", "Sigma_max")}
    V_g = np.array(record["V_g"]).reshape(len(record["V_g"]), -1, 2)
    U_tilde = U_hat = np.zeros(V_g.shape[1:])
    for solve in record["solves"]:
        normals = iter(solve["normals"])

        def normal(n):
            return np.array([next(normals) for _ in range(n * U_hat.size)]).reshape(n, *U_hat.shape)

        U_tilde, Sigma, U_hat = example.svg_mppi(cost, normal, V_g, U_hat, U_tilde, lam=record["lambda"], **settings)
        assert next(normals, None) is None
        for name, value in (("U_tilde", U_tilde), ("Sigma", Sigma), ("U_hat", U_hat)):
            assert value.ravel() == pytest.approx(solve[name], abs=2e-4), name
