"""Derivatives of problems, for feedback between two plans."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _slalom, display
from .closed_loop import Array


class Linearization(NamedTuple):
    """A problem around a state and inputs, float64; n = states + inputs. Without inputs, its terminal cost."""
    next: Array            # the state after the step, (states,)
    state_jacobian: Array  # derivative of `next` by the state, (states, states)
    input_jacobian: Array  # by the inputs, (states, inputs)
    cost: Array            # ()
    gradient: Array        # derivative of the cost by state and inputs, (n,)
    hessian: Array         # (n, n)
    kink: Array            # 1 where a function has no derivative, else 0; of callables always 0; ()


def linearize(problem: _slalom.AnyProblem, state: ArrayLike, inputs: ArrayLike = (), k: int = 0) -> Linearization:
    """The exact derivatives of a problem that `slalom.compile(..., derivatives=True)` made. Those of callables are central
    differences, about eight digits of functions that compute in double for arrays of double."""
    x, u = np.array(state, float), np.array(inputs, float)
    is_callable = isinstance(problem, _slalom.Problem) and problem.dynamics
    parts = _differences(problem, x, u, k) if is_callable else getattr(problem, "_expand")(x, u, k)
    if not parts:
        raise TypeError(f"linearize: {problem!r} has no derivatives: slalom.compile(problem, derivatives=True) makes them for "
                        "structs in C++ and for built-in problems")
    n, rows = len(x) + len(u), len(x) * bool(len(u))
    shapes: list[tuple[int, ...]] = [(len(x),), (rows, len(x)), (rows, len(u)), (), (n,), (n, n), ()]
    return Linearization._make(np.reshape(part, shape) for part, shape in zip(parts, shapes))


def _differences(problem: Any, x: Array, u: Array, k: int) -> list[Any]:
    """The parts of a Linearization; each function is called once, with all points."""
    z = np.concatenate([x, u])
    steps, n, states = np.diag(1e-4 * np.maximum(1, np.abs(z))), len(z), len(x)
    corners = [a * steps[:, None] + b * steps for a, b in ((1, 1), (1, -1), (-1, 1), (-1, -1))]
    points = z + np.concatenate([np.zeros((1, n)), steps, -steps, np.reshape(corners, (-1, n))])
    half = 0.5 / np.diag(steps)

    def at_points(name: str) -> Array:
        function = getattr(problem, name) or (lambda _: np.zeros(len(points)))
        found = function(*np.split(points, [states], axis=1)[:1 + bool(len(u))], *[k] * display.takes_k(function))
        found = found[0] if isinstance(found, tuple) else found  # without collisions
        values = np.asarray(sum(found.values()) if isinstance(found, dict) else found)
        if values.dtype != np.float64:
            raise TypeError(f"linearize: Problem.{name}: returned {values.dtype} for arrays of float64; must compute in float64")
        return values

    costs, moved = at_points("cost" if len(u) else "terminal_cost"), at_points("dynamics") if len(u) else points[:, :states]
    jacobian = ((moved[1:n + 1] - moved[n + 1:2 * n + 1]) * half[:, None]).T[:states * bool(len(u))]
    both, upper, lower, neither = costs[2 * n + 1:].reshape(4, n, n)
    return [moved[0], jacobian[:, :states], jacobian[:, states:], costs[0], (costs[1:n + 1] - costs[n + 1:2 * n + 1]) * half,
            (both - upper - lower + neither) * np.outer(half, half), 0.0]


class Feedback:
    """Linear feedback around the plans of a controller, for the time until the next one: the gains of the linear-quadratic
    regulator along the plan, as slalom::Feedback in C++ (docs/derivatives.md) computes them. `gains`,
    float64 (horizon, inputs, states), are the change of the inputs by deviation from the plan's states."""

    def __init__(self, controller: _slalom.Controller) -> None:
        problem = controller.problem
        self.gains = np.zeros((controller.horizon, problem.inputs, problem.states))
        self._bounds = [np.broadcast_to(controller.options[name], problem.inputs) for name in ("input_min", "input_max")]
        self._states, self._inputs = np.zeros((controller.horizon + 1, problem.states)), self.gains[:, :, 0]
        self._time_step = problem.time_step or 1.0

    def update(self, plan: _slalom.Plan) -> bool:
        """Computes the gains along a plan. Returns False, and all gains are 0, if a derivative is not finite."""
        problem, x, u = plan.controller.problem, plan.states, plan.inputs
        self._states, self._inputs, n = x, u, problem.states
        gains, end = np.zeros(self.gains.shape), linearize(problem, x[-1])
        value, slope = _semidefinite(end.hessian), end.gradient
        for k in reversed(range(len(u))):
            around = linearize(problem, x[k], u[k], k)
            jacobian = np.hstack([around.state_jacobian, around.input_jacobian])
            hessian = _semidefinite(around.hessian) + jacobian.T @ value @ jacobian
            gradient = around.gradient + jacobian.T @ slope
            if not (np.isfinite(hessian).all() and np.isfinite(gradient).all()):
                self.gains = np.zeros(gains.shape)
                return False
            held = [np.isclose(u[k], bound, 1e-6, 1e-6) & (sign * gradient[n:] > 0) for sign, bound in zip((1, -1), self._bounds)]
            free = n + np.flatnonzero(~(held[0] | held[1]))  # an input at a bound beyond which the cost falls gets no feedback
            largest = hessian[free, free].max(initial=0)
            if largest > 0:
                within = hessian[np.ix_(free, free)] + 1e-10 * largest * np.eye(len(free))
                gains[k, free - n] = -np.linalg.solve(within, hessian[free, :n])
            follow = np.vstack([np.eye(n), gains[k]])
            value, slope = follow.T @ hessian @ follow, follow.T @ gradient
        self.gains = gains
        return True

    def input_at(self, t: float, state: ArrayLike) -> Array:
        """The inputs, shape (inputs,), within their bounds, for a state, shape (states,), at `t` (s) after the plan was made."""
        at = float(np.clip(t / self._time_step, 0, len(self._inputs)))
        k = min(int(at + 1e-9), len(self._inputs) - 1)
        planned = self._states[k] + (at - k) * (self._states[k + 1] - self._states[k])
        return np.clip(self._inputs[k] + self.gains[k] @ np.nan_to_num(np.asarray(state) - planned), *self._bounds)


def _semidefinite(matrix: Array) -> Array:
    """The nearest positive semidefinite matrix."""
    if not np.isfinite(matrix).all():
        return matrix
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2)
    return np.asarray((vectors * np.maximum(values, 0)) @ vectors.T)
