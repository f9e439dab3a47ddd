"""A controller as a node of ROS 2: `spin` is the node, `Loop` its logic, which needs no ROS."""

from __future__ import annotations

from typing import Any, Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _slalom, display


class Loop:
    """Commands of a controller from the newest state of a robot.

    `safe` is sent without a state that is at most `timeout` old, where the solver has no answer, and where all samples and the
    plan collide. `plan` is that of the last command, or None; `why` is the reason for which it was `safe`, or empty.
    """

    def __init__(self, controller: _slalom.Controller, safe: ArrayLike, *, timeout: float = 0.1, deadline: float = 0.01) -> None:
        self.controller, self.timeout, self.deadline = controller, timeout, deadline
        self.safe = np.array(safe, float).reshape(controller.problem.inputs)
        self.plan: _slalom.Plan | None = None
        self.why = "no state yet"
        self._state: ArrayLike | None = None
        self._stamp, self._solved = 0.0, np.nan

    def hear(self, state: ArrayLike, stamp: float) -> None:
        """Takes the state, shape (states,), at a time (s)."""
        self._state, self._stamp = state, stamp

    def command(self, now: float) -> NDArray[np.float64]:
        """Returns the inputs, shape (inputs,), for a time (s)."""
        self.plan, age = None, now - self._stamp
        if self._state is not None and not -0.05 <= age <= self.timeout:
            self.why = f"the newest state is {age:.2f} s old"
        elif self._state is not None:
            elapsed = 0 if np.isnan(self._solved) else max(now - self._solved, 0)
            self.plan, self._solved = self.controller.solve(self._state, elapsed=elapsed, deadline=self.deadline), now
            trusted = ("ok", "deadline") if self.plan.collided else ("ok", "deadline", "all_collided")
            self.why = "" if self.plan.status in trusted else self.plan.status
        return self.safe if self.why else self.plan.inputs[0]


def spin(loop: Loop, state: tuple[type, str, Callable[[Any], ArrayLike]], command: tuple[type, str, Callable[[Any], Any]], *,
         name: str = "slalom", period: float = 0.05) -> None:
    """Runs a node that sends the commands of `loop` every `period` (s), until it is interrupted; then it sends `loop.safe`.

    `state` is a type of messages, a topic, and a function that returns the state of a message, whose time is that of its
    header, or else of its arrival. `command` is a type, a topic, and a function that returns a message for inputs. The topic
    `~/plan` has the states of the plans, step by step.
    """
    import rclpy
    from rclpy.qos import qos_profile_sensor_data
    from rclpy.signals import SignalHandlerOptions
    from std_msgs.msg import Float64MultiArray

    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node(name)
    commands, plans = node.create_publisher(*command[:2], 1), node.create_publisher(Float64MultiArray, "~/plan", 1)

    def now() -> float:
        return node.get_clock().now().nanoseconds * 1e-9

    def hear(message: Any) -> None:
        stamp = message.header.stamp if hasattr(message, "header") else None
        loop.hear(state[2](message), stamp.sec + 1e-9 * stamp.nanosec if stamp else now())

    def tick() -> None:
        commands.publish(command[2](loop.command(now())))
        if loop.plan:
            plans.publish(Float64MultiArray(data=loop.plan.states.ravel().tolist()))
        if loop.why:
            node.get_logger().warning(f"stopping: {loop.why}", throttle_duration_sec=1.0)

    node.create_subscription(*state[:2], hear, qos_profile_sensor_data)
    node.create_timer(period, tick)
    try:
        rclpy.spin(node)
    finally:
        commands.publish(command[2](loop.safe))
        node.destroy_node()
        rclpy.shutdown()


display.describe_all(globals(), __name__)
