"""Drives in closed loop: a controller, and a plant that does what it says."""

from __future__ import annotations

import importlib
import time
from typing import Any, Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _slalom

Array = NDArray[Any]


class Run:
    """A drive in closed loop, as `slalom.run` returns it.

    Attributes
    ----------
    states : float64, shape (steps + 1, states)
    inputs : float64, shape (steps, inputs)
    costs : float64, shape (steps,)
        the cost of each step by the problem, without its terminal cost
    times : float64, shape (steps,)
        how long each command took, s
    time_step : float
        s, of the problem; 0: unknown
    """

    def __init__(self, states: ArrayLike, inputs: ArrayLike, costs: ArrayLike, times: ArrayLike, time_step: float) -> None:
        values: list[NDArray[np.float64]] = [np.array(each, float) for each in (states, inputs, costs, times)]
        self.states, self.inputs, self.costs, self.times = values
        self.time_step = time_step

    def frame(self) -> Any:
        """All as a pandas.DataFrame, a row for each state, the last without inputs; the index is the time, s, or the step."""
        pandas = importlib.import_module("pandas")
        columns = {f"{name} {i}": column for name, values in (("state", self.states), ("input", self.inputs))
                   for i, column in enumerate(values.T)}
        rows = {name: np.append(column, [np.nan] * (len(self.states) - len(column)))
                for name, column in {**columns, "cost": self.costs, "solve time, s": self.times}.items()}
        index = np.arange(len(self.states)) * (self.time_step or 1)
        return pandas.DataFrame(rows, index=pandas.Index(index, name="time, s" if self.time_step else "step"))

    def __repr__(self) -> str:
        return (f"<slalom.Run of {len(self.inputs)} steps: cost {self.costs.sum():.6g}, "
                f"{1e3 * np.median(self.times) if len(self.times) else 0:.3g} ms for a solve>")


def run(problem: _slalom.AnyProblem, controller: _slalom.Controller | Callable[[Array], ArrayLike], x0: ArrayLike,
        steps: int, plant: Callable[[Array, Array], ArrayLike] | None = None) -> Run:
    """Drives a controller in closed loop.

    Parameters
    ----------
    problem : AnyProblem
        gives the costs, and the dynamics of the plant where `plant` is not given
    controller : Controller, or callable
        commands the inputs; its own problem may be another one. A callable gets the state, shape (states,), and returns
        inputs, shape (inputs,)
    x0 : array_like, shape (states,)
        the first state
    steps : int
    plant : callable, optional
        the real system: the next state, shape (states,), for a state and inputs, shape (inputs,)

    Returns
    -------
    Run
        states, inputs, costs and times
    """
    move = plant or problem.step

    def step(k: int, x: Array, u: Array) -> tuple[Array, float, bool]:
        return _vector(move(x.copy(), u.copy()), problem.states, f"plant: step {k}: state"), step_cost(problem, x, u), False

    command = controller.command if isinstance(controller, _slalom.Controller) else controller
    return drive(command, _vector(x0, problem.states, "x0"), step, steps, problem)


def drive(command: Callable[[Array], ArrayLike], x: Array, step: Callable[[int, Array, Array], tuple[Array, float, bool]],
          steps: int, problem: _slalom.AnyProblem) -> Run:
    """Drives from the state `x`. `step` returns the next state, the cost, and whether the drive ends."""
    states, rows, ends = [x], [(np.zeros(problem.inputs), 0.0, 0.0)][:0], False
    while len(rows) < steps and not ends:
        begin = time.perf_counter()
        u = _vector(command(x.copy()), problem.inputs, f"controller: step {len(rows)}: inputs")
        took = time.perf_counter() - begin
        x, cost, ends = step(len(rows), x, u)
        states.append(x)
        rows.append((u, cost, took))
    inputs = np.reshape([row[0] for row in rows], (-1, problem.inputs))
    return Run(states, inputs, [row[1] for row in rows], [row[2] for row in rows], problem.time_step)


def step_cost(problem: _slalom.AnyProblem, x: Array, u: Array) -> float:
    """The cost of a step of a problem, without the terminal cost."""
    following, cost = problem.predict(x, u[None])
    return float(cost - problem.predict(following[-1], u[None][:0])[1])


def _vector(values: ArrayLike, count: int, what: str) -> Array:
    vector = np.array(values, float)
    if vector.shape != (count,) or not np.isfinite(vector).all():
        raise ValueError(f"{what}: {vector} must be {count} finite numbers, shape ({count},)")
    return vector
