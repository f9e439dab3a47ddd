"""A robot drives past a person whom a detector of its own sees: a camera that finds where the person is to 3 cm."""

import sys

import numpy as np
import slalom
from seeds import SEEDS, succeeded

PERIOD = 0.05  # s
room = slalom.Costmap(slalom.OccupancyGrid(np.zeros((60, 100)), 0.1))  # 10 x 6 m; people are not in it
body = slalom.Footprint.rectangle(front=0.25, rear=0.25, width=0.4)


def passes(seed):
    random = np.random.default_rng(seed)
    navigator, predictor = slalom.Navigator(body, room), slalom.Predictor(people=True)
    navigator.reset(seed)
    navigator.set_path([(1, 3, 0), (9, 3, 0)])
    pose, velocity = np.array([1.0, 3.0, 0.0]), (0.0, 0.0, 0.0)
    person, walk = np.array([4, 0.4]), np.array([0, random.uniform(0.38, 0.46)])  # m, m/s: both come to (4, 3) together
    place, speed = person, np.zeros(2)  # as the detector filters them
    for k in range(600):
        person = person + PERIOD * walk
        error = person + random.normal(0, 0.03, 2) - (place + PERIOD * speed)
        place, speed = place + PERIOD * speed + 0.3 * error, speed + 0.06 / PERIOD * error
        seen = slalom.TrackedObject(1, (*place, np.arctan2(*speed[::-1])), speed=np.hypot(*speed), length=0.5, width=0.5)
        result = navigator.update(pose, velocity, room, PERIOD, predictor.update([seen], PERIOD * k))
        if result["status"] == "goal_reached":
            return True
        velocity = forward, _, turn = result["command"]
        pose = pose + PERIOD * np.array([forward * np.cos(pose[2]), forward * np.sin(pose[2]), turn])
        if np.hypot(*(person - pose[:2])) < 0.5:
            return False
    return False


sys.exit(succeeded("the robot passes the person", passes) < SEEDS)
