"""The simulator with the interface of Gymnasium. Where gymnasium is not installed, it has no spaces."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._driving import Course, World

try:
    import gymnasium  # type: ignore[import]
except ImportError:
    gymnasium = None
Base: Any = gymnasium.Env if gymnasium else object


class RacingEnv(Base):  # type: ignore[misc]
    """One car on a course.

    Action: (steering angle rad, speed m/s). Observation: the LiDAR ranges (m), then speed (m/s), yaw rate
    (rad/s) and steering angle (rad). The reward is the progress along the course (m); a collision ends the
    episode and costs `contact_penalty`; a complete lap also ends it.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, course: str | Course = "wren", *, control_period: float = 0.025, beams: int = 108,
                 max_speed: float = 8.0, max_steer: float = 0.4189, contact_penalty: float = 10.0,
                 timeout: float = 60.0) -> None:
        self.course = Course(course) if isinstance(course, str) else course
        steps = max(1, math.ceil(control_period / 0.005 - 1e-9))
        self.world = World(self.course, time_step=control_period / steps, beams=beams)
        self.contact_penalty = contact_penalty
        self.timeout = timeout
        self._steps = steps
        self._seed = 0
        self._limits = np.array([[-max_steer, 0], [max_steer, max_speed]], np.float32)
        if gymnasium:
            low, high = (np.append(np.full(beams, ranges), rest).astype(np.float32)
                         for ranges, rest in ((0, [-50, -50, -1.6]), (100, [50, 50, 1.6])))
            self.action_space = gymnasium.spaces.Box(*self._limits)
            self.observation_space = gymnasium.spaces.Box(low, high)

    def _observe(self) -> tuple[NDArray[np.float32], dict[str, Any]]:
        seen = self.world.observe()
        rest = [seen["speed"], seen["yaw_rate"], seen["steer"]]
        keep = ("pose", "time", "contact", "laps", "progress", "lateral")
        info = {key: seen[key] for key in keep if key in seen}
        return np.concatenate([seen["ranges"], rest]).astype(np.float32), info

    def reset(self, *, seed: int | None = None,
              options: dict[str, Any] | None = None) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Returns the first observation and info. `options` may have "start" and "parked" (poses x, y, yaw)."""
        if gymnasium:
            super().reset(seed=seed)
        options = options or {}
        self._seed = self._seed + 1 if seed is None else seed
        self.world.reset(self._seed, [options.get("start", self.course.start)], options.get("parked", []))
        observation, info = self._observe()
        self._progress = info["progress"]
        return observation, info

    def step(self, action: ArrayLike) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Returns observation, reward, terminated, truncated, info."""
        action = np.asarray(action, float)
        if action.shape != (2,):
            raise ValueError(f"action: has shape {action.shape}, must be (2,)")
        command = np.clip(action, *self._limits)
        for _ in range(self._steps):
            self.world.step([tuple(command)])
            contact = self.world.observe()["contact"]
            if contact:
                break
        observation, info = self._observe()
        info["contact"] = contact
        reward = info["progress"] - self._progress - self.contact_penalty * contact
        self._progress = info["progress"]
        done = bool(contact or info["laps"] > 0)
        return observation, float(reward), done, info["time"] >= self.timeout, info

    def close(self) -> None:
        pass
