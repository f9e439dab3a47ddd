"""Environments of gymnasium: an Env as a Problem, and a Problem as an Env (docs/python.md)."""

from __future__ import annotations

import copy
from typing import Any, Callable

import gymnasium
import numpy as np
from numpy.typing import ArrayLike

from . import _slalom, display
from .closed_loop import Array, Run, drive, step_cost


def _access(env: gymnasium.Env[Any, Any]) -> tuple[Callable[[], Array], Callable[[Array], None]]:
    """Functions that return and set the state of an environment, shape (states,): positions and velocities of MuJoCo, or
    the attribute `state`, or all attributes that are numbers."""
    inner: Any = env.unwrapped
    if hasattr(inner, "set_state"):
        def set_simulation(x: Array) -> None:
            inner.data.qacc_warmstart[:] = 0  # equal states give equal steps
            inner.set_state(*np.split(x, [inner.model.nq]))

        return lambda: np.concatenate([inner.data.qpos, inner.data.qvel]), set_simulation

    def kind(value: Any) -> str:
        return np.asarray(value).dtype.kind if isinstance(value, (bool, float, int, list, tuple, np.ndarray, np.number)) else ""

    held = {name: value for name, value in vars(inner).items() if kind(value) in ("f", "i", "u", "b") and np.size(value)}
    names = ["state"] if "state" in held else [*held]

    def set_numbers(x: Array) -> None:
        for name in names:
            before = held[name]
            part, x = x[:np.size(before)], x[np.size(before):]
            after = part.reshape(np.shape(before)).astype(np.asarray(before).dtype)
            setattr(inner, name, after if isinstance(before, np.ndarray) else type(before)(after.tolist()))

    if names == ["state"]:
        return lambda: np.array(inner.state, float), set_numbers
    return lambda: np.concatenate([np.ravel(getattr(inner, name)).astype(float) for name in names]), set_numbers


def state_of(env: gymnasium.Env[Any, Any]) -> Array:
    """The state of an environment."""
    return _access(env)[0]()


class Problem(_slalom.Problem):
    """An environment as a problem: rollouts are steps of a copy, costs are rewards less than 0."""

    def __init__(self, env: gymnasium.Env[Any, Any], terminal_cost: Callable[[Array], Array] | None = None, **parts: Any) -> None:
        env.reset()
        inner = _copied(env)
        space = inner.action_space
        if not isinstance(space, gymnasium.spaces.Box) or len(space.shape) != 1:
            raise TypeError(f"env: its actions, {space}, must be a Box of shape (inputs,)")
        state, set_state = _access(inner)
        states = len(state())

        def rollout(x: Array, u: Array) -> tuple[Array, Array]:
            costs, paths = np.zeros(len(u)), np.empty((len(u), u.shape[1] + 1, states))
            paths[:] = x
            for sample, actions in enumerate(u.astype(space.dtype)):
                set_state(x)
                for k, action in enumerate(actions, 1):
                    _, reward, ends, _, _ = inner.step(action)
                    costs[sample] -= reward
                    paths[sample, k:] = state()
                    if ends:  # the rest of the episode costs nothing
                        break
            return costs + (terminal_cost(paths[:, -1]) if terminal_cost else 0), paths

        super().__init__(states=states, inputs=space.shape[0], rollout=rollout,
                         dt=float(getattr(inner, "dt", None) or getattr(inner, "tau", 1)),
                         **{"input_min": space.low.tolist(), "input_max": space.high.tolist(), **parts})


def _copied(env: gymnasium.Env[Any, Any]) -> Any:
    """A copy of the innermost environment that draws nothing, since what draws cannot be copied."""
    inner = env.unwrapped
    drawing = [vars(inner).get(name) for name in ("mujoco_renderer", "screen", "clock", "window", "surf")]
    made = copy.deepcopy(inner, {id(each): None for each in drawing if each is not None})
    made.render_mode = None
    return made


def episode(env: gymnasium.Env[Any, Any], controller: _slalom.Controller, seed: int | None = None, steps: int = 1_000_000) -> Run:
    """Drives an environment until its episode ends, or for a number of steps."""
    def step(_: int, x: Array, u: Array) -> tuple[Array, float, bool]:
        _, reward, terminated, truncated, _ = env.step(u.astype(getattr(env.action_space, "dtype")))
        return state_of(env), -float(reward), terminated or truncated

    env.reset(seed=seed)
    return drive(controller.command, state_of(env), step, steps, controller.problem)


class Env(gymnasium.Env[Array, Array]):
    """A problem as an environment: observations are states, actions inputs, rewards costs less than 0."""

    def __init__(self, problem: _slalom.AnyProblem, start: ArrayLike | Callable[[np.random.Generator], ArrayLike],
                 steps: int = 200) -> None:
        self.problem, self.steps, self.state, self._done = problem, steps, np.zeros(problem.states), 0
        self._start = start
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (problem.states,), np.float64)
        self.action_space = gymnasium.spaces.Box(*problem.bounds, dtype=np.float64)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        super().reset(seed=seed)
        self.state = np.array(self._start(self.np_random) if callable(self._start) else self._start, float)
        self._done = 0
        return self.state.copy(), {}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        u = np.clip(np.asarray(action, float), *self.problem.bounds)
        reward = -step_cost(self.problem, self.state, u)
        self.state = self.problem.step(self.state, u)
        self._done += 1
        return self.state.copy(), reward, self.problem.collides(self.state), self._done >= self.steps, {}


display.describe_all(globals(), __name__)
