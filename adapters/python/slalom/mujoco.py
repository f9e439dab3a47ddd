"""Models of MuJoCo as problems, simulated on several threads (docs/python.md)."""

from __future__ import annotations

import os
from typing import Any, Callable

import mujoco
import numpy as np
from mujoco import rollout as simulation

from . import _slalom, display
from .closed_loop import Array


class Problem(_slalom.Problem):
    """A model of MuJoCo as a problem. A state is qpos, qvel and act; inputs are ctrl, within its ctrlrange.

    Attributes
    ----------
    model : mujoco.MjModel
    start : float64, shape (states,)
        the state of the model as it is loaded
    """

    def __init__(self, model: Any, cost: Callable[..., Array], terminal_cost: Callable[[Array], Array] | None = None, *,
                 physics_steps: int = 1, threads: int | None = None, **parts: Any) -> None:
        if not isinstance(model, mujoco.MjModel):
            text = os.fspath(model)
            model = mujoco.MjModel.from_xml_string(text) if "<" in text else mujoco.MjModel.from_xml_path(text)
        self.model, sees_sensors = model, display.takes_k(cost)
        count = min(threads or os.cpu_count() or 1, 64)
        data = [mujoco.MjData(model) for _ in range(count)]
        self.start = self.state_of(data[0])
        states, whole = len(self.start), mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        pool = simulation.Rollout(nthread=count)

        def rollout(x: Array, u: Array) -> tuple[Array, Array]:
            samples, steps, inputs = u.shape
            begin = np.zeros((1, whole))
            begin[0, 1:1 + states] = x  # after the time
            controls = np.repeat(u.astype(float), physics_steps, axis=1)
            after, sensors = pool.rollout(model, data, begin, controls)
            paths = np.empty((samples, steps + 1, states))
            paths[:, 0], paths[:, 1:] = x, after[:, physics_steps - 1::physics_steps, 1:1 + states]
            places = paths[:, :-1].reshape(-1, states)
            seen = [sensors[:, ::physics_steps].reshape(len(places), -1)] * sees_sensors
            costs = np.asarray(cost(places, u.reshape(-1, inputs), *seen)).reshape(samples, steps).sum(axis=1)
            costs = costs + (terminal_cost(paths[:, -1]) if terminal_cost else 0)
            lost = ~np.isfinite(paths).all(axis=(1, 2))
            return np.where(lost, np.inf, costs), np.nan_to_num(paths)

        limited = model.actuator_ctrllimited.astype(bool)[:, None]
        bounds = np.where(limited, model.actuator_ctrlrange, [-np.inf, np.inf]).T.tolist()
        super().__init__(states=states, inputs=model.nu, dt=physics_steps * model.opt.timestep, rollout=rollout,
                         **{"input_min": bounds[0], "input_max": bounds[1], **parts})

    def state_of(self, data: Any) -> Array:
        """The state of a simulation, shape (states,)."""
        return np.concatenate([data.qpos, data.qvel, data.act])


display.describe_all(globals(), __name__)
