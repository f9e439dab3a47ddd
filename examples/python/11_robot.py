"""A robot drives past a pallet that its path ignores; a second argument names a picture of the drives."""

import sys

import numpy as np
import slalom
from seeds import SEEDS, succeeded

cells = np.zeros((100, 180), dtype=bool)  # 9 x 5 m
cells[[0, -1], :] = cells[:, [0, -1]] = True
free = slalom.OccupancyGrid(cells, 0.05)
cells[38:62, 80:96] = True
costmap = slalom.Costmap(slalom.OccupancyGrid(cells, 0.05))
body = slalom.Footprint.rectangle(front=0.35, rear=0.35, width=0.5)
path = slalom.plan_path(slalom.Costmap(free), body, (1, 2.5, 0), (8, 2.5, np.pi / 2))
ways = []


def arrives(seed):
    navigator = slalom.Navigator(body, costmap, max_forward=0.5)
    navigator.reset(seed)
    navigator.set_path(path)
    pose, velocity, way = np.array([1.0, 2.5, 0.0]), (0.0, 0.0, 0.0), []
    while len(way) < 800:
        result = navigator.update(pose, velocity, costmap, elapsed=0.05)
        if result["status"] == "goal_reached":
            break
        velocity = forward, _, turn = result["command"]  # a robot that does as it is told
        pose = pose + 0.05 * np.array([forward * np.cos(pose[2]), forward * np.sin(pose[2]), turn])
        way.append(pose)
    ways.append(np.array(way))
    return result["status"] == "goal_reached" and not any(costmap.collides(body, each) for each in way)


arrived = succeeded("the robot arrives", arrives)
if len(sys.argv) > 2:
    from matplotlib.figure import Figure

    axes = Figure(figsize=(9, 5)).subplots()
    axes.imshow(cells, cmap="Greys", origin="lower", extent=(0, 9, 0, 5))
    axes.plot(path[:, 0], path[:, 1], "k--")
    for way in ways:
        axes.plot(way[:, 0], way[:, 1])
    axes.figure.savefig(sys.argv[2])
sys.exit(arrived < SEEDS)
