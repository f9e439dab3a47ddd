"""Somebody steps in front of a delivery robot; a brake is proposed beside the samples of MPPI."""

import numpy as np
import slalom
from seeds import SEEDS, succeeded

DT, SPEED = np.float32(0.05), np.float32(6)  # s, m/s
HORIZON = 40  # steps
BRAKE = -6.0  # m/s^2
person = {"at": 1000.0}  # m, place of the person in the way


def collides(s):
    return s[:, 0] > np.float32(person["at"] - 0.5)


def dynamics(s, u):  # states: position, speed; input: acceleration
    speed = np.maximum(s[:, 1] + DT * u[:, 0], np.float32(0))  # it does not drive back
    return np.stack([s[:, 0] + DT * speed, speed]).T


def cost(s, u):
    hit = collides(s)
    return DT * ((s[:, 1] - SPEED) ** 2 + np.float32(0.05) * u[:, 0] ** 2) + np.float32(100) * hit, hit


robot = slalom.Problem(dynamics, cost, states=2, inputs=1, dt=float(DT), input_min=BRAKE, input_max=2)
brake = np.full((HORIZON, 1), BRAKE)  # a robot that stands does not drive back


def stops(seed, proposals):
    """Whether the robot stops in time for a person who steps into its way 4 m ahead. It needs 3 m to stop."""
    controller = slalom.Mppi(robot, horizon=HORIZON, samples=512, control_cost_discount=1, seed=seed)
    person["at"] = 1000.0
    s = np.array([0.0, float(SPEED)])
    for k in range(60):
        if k == 10:
            person["at"] = s[0] + 4
        s = robot.step(s, controller.solve(s, elapsed=float(DT), proposals=proposals).inputs[0])
        if collides(s[None])[0]:
            return False
    return True


alone = succeeded(lambda seed: stops(seed, []))
braked = succeeded(lambda seed: stops(seed, brake))
print(f"the robot stops in time in {alone} of {SEEDS} runs, with a brake as proposal in {braked}")
assert braked == SEEDS and alone < 0.25 * SEEDS
