"""A car's slip on a slippery floor is learned from laps that it has driven with a model without slip.

The network learns from the poses and commands of five laps of one course; the car then drives another course. Random
changes of the recorded commands and the mirror image of each step show the network the states and commands that a plan
samples. With a second argument, writes the network to that file: examples/learned/car.npz, which 15_slip.cpp reads.
"""

import sys

import numpy as np
import slalom
from seeds import SEEDS
from slalom.mlp import train_mlp

DT, STEPS = 0.05, 10  # s, of a plan's step; steps of the world in it
FRICTION = 0.4
STEER_MAX, STEER_RATE = 0.4189, 3.2  # rad, rad/s
REAR_LENGTH, WHEELBASE = 0.17145, 0.3302  # m, from the rear axle to the centre of gravity and to the front axle


class Line:
    """The line of a course as maps: the square of the distance to it (m^2), and its speed (m/s)."""

    def __init__(self, name):
        self.course = slalom.Course(name)
        points = self.points = self.course.waypoints

        def nearest(x, y):
            return points[np.argmin((x[..., None] - points[:, 0]) ** 2 + (y[..., None] - points[:, 1]) ** 2, axis=-1)]

        def square_distance(x, y):
            p = nearest(x, y)
            return ((y - p[..., 1]) * np.cos(p[..., 2]) - (x - p[..., 0]) * np.sin(p[..., 2])) ** 2

        low, high = points[:, :2].min(0) - 2, points[:, :2].max(0) + 2
        width, height = np.ceil((high - low) / 0.1).astype(int).tolist()
        grid = width, height, 0.1, (*low, 0)
        self.square_distance = slalom.Field.from_function(square_distance, *grid)
        self.speed = slalom.Field.from_function(lambda x, y: nearest(x, y)[..., 3], *grid)

    def distance(self, s):
        return np.hypot(self.points[:, 0] - s[0], self.points[:, 1] - s[1]).min()


# A state is x, y (m), yaw (rad) of the centre of gravity, its speeds ahead and to the left (m/s), yaw rate (rad/s) and
# steering angle (rad). Inputs are the commands to the car: steering angle (rad) and speed (m/s).


def steered(s, u):
    """The steering angle after a step."""
    return np.clip(u[:, 0], s[:, 6] - STEER_RATE * DT, s[:, 6] + STEER_RATE * DT)


def without_slip(s, u, steer):
    """Speeds and yaw rate after a step, if no wheel slips sideways."""
    acceleration = np.clip(np.where(u[:, 1] > s[:, 3], 4.755, 19.02) * (u[:, 1] - s[:, 3]), -9.51, 9.51)
    speed = s[:, 3] + DT * acceleration
    yaw_rate = speed * np.tan(steer) / WHEELBASE
    return np.stack([speed, REAR_LENGTH * yaw_rate, yaw_rate]).T


def features(s, u, steer):
    """What the network predicts speeds and yaw rate from; these come first, since the network is residual."""
    return np.stack([s[:, 3], s[:, 4], s[:, 5], s[:, 6], steer, u[:, 1]]).T


def moved(s, steer, following):
    """The state after a step to given speeds and yaw rate: along the means of the step."""
    ahead, left, yaw_rate = (DT * 0.5 * (s[:, 3:6] + following)).T
    cosine, sine = np.cos(s[:, 2] + 0.5 * yaw_rate), np.sin(s[:, 2] + 0.5 * yaw_rate)
    return np.stack([s[:, 0] + ahead * cosine - left * sine, s[:, 1] + ahead * sine + left * cosine,
                     s[:, 2] + yaw_rate, *following.T, steer]).T


def problem(line, network, pace):
    """Follows the line at a share of its speeds. Without a network the model has no slip."""

    def dynamics(s, u):
        steer = steered(s, u)
        return moved(s, steer, network(features(s, u, steer)) if network else without_slip(s, u, steer))

    def cost(s, u):
        speed_error = s[:, 3] - np.float32(pace) * line.speed.value(s[:, 0], s[:, 1])
        return np.float32(DT) * (np.float32(20) * line.square_distance.value(s[:, 0], s[:, 1]) + speed_error**2)

    return slalom.Problem(dynamics, cost, states=7, inputs=2, dt=DT, input_min=[-STEER_MAX, 0], input_max=[STEER_MAX, 8])


def observed(world, before):
    """The state of the car; its speeds come from its pose now and one step of the world before."""
    now = world.observe()
    (x, y, yaw), (x_before, y_before, yaw_before) = now["pose"], before
    way_x, way_y = (x - x_before) / world.time_step, (y - y_before) / world.time_step
    cosine, sine = np.cos(0.5 * (yaw + yaw_before)), np.sin(0.5 * (yaw + yaw_before))
    return np.array([x, y, yaw, way_x * cosine + way_y * sine, way_y * cosine - way_x * sine, now["yaw_rate"], now["steer"]])


def drive(line, network, pace, seed, excitation=(0, 0)):
    """A lap: whether it is finished in time without touching a wall, the root mean square of the distance to the line
    after the first second (m), and the recording: states, inputs and the states after them.

    excitation: standard deviations of what is added to the inputs (rad, m/s), drawn every four steps
    """
    world = slalom.World(line.course, friction=FRICTION, wall_response="count_only", beams=2, scan_rate=1)
    world.reset(seed, [line.course.start])
    controller = slalom.Mppi(problem(line, network, pace), horizon=15, samples=256, temperature=0.05,
                             variance=[0.015, 0.5], control_cost_discount=1, seed=seed)
    random, added = np.random.default_rng(seed), 0
    s, touched, recording = np.array([*line.course.start, 0, 0, 0, 0]), False, []
    while world.observe()["laps"] < 1 and world.time < line.course.length / (2.6 * pace):
        if len(recording) % 4 == 0:
            added = random.normal(0, excitation)
        u = np.clip(controller.solve(s, elapsed=DT).inputs[0] + added, [-STEER_MAX, 0], [STEER_MAX, 8])
        world.step([tuple(u)], STEPS - 1)
        before = world.observe()["pose"]
        world.step([tuple(u)])
        following = observed(world, before)
        recording.append((s, u, following))
        s, touched = following, touched or world.observe()["contact"]
    distances = np.array([line.distance(each) for _, _, each in recording[20:]])
    finished = world.observe()["laps"] >= 1 and not touched
    return finished, np.sqrt(np.mean(distances**2)), [np.array(column) for column in zip(*recording)]


known = Line("wren")
laps = [drive(known, None, pace, seed, (0.1, 1.5))[2] for seed, pace in enumerate((0.7, 0.8, 0.9, 1.0, 1.1))]
states, inputs, following = (np.concatenate(column) for column in zip(*laps))
before, after = features(states, inputs, steered(states, inputs)), following[:, 3:6]
# The mirror image of a step is a step, too.
before = np.concatenate([before, before * [1, -1, -1, -1, -1, 1]])
after = np.concatenate([after, after * [1, -1, -1]])
network = train_mlp(before, after, hidden=(24, 24), residual=True, epochs=400, batch=128)
if len(sys.argv) > 2:
    network.save(sys.argv[2])

other = Line("mole")
runs = {name: [drive(other, each, 1.0, 100 + seed)[:2] for seed in range(SEEDS)]
        for name, each in {"without slip": None, "with the network": network}.items()}
finished = {name: sum(done for done, _ in each) for name, each in runs.items()}
distance = {name: np.mean([d for _, d in each]) for name, each in runs.items()}
for name in runs:
    print(f"a lap on a slippery floor, planned {name}: {finished[name]} of {SEEDS} seeds finish without touching a wall, "
          f"{distance[name]:.3f} m from the line")
assert finished["with the network"] >= 0.9 * SEEDS
assert distance["with the network"] < 0.6 * distance["without slip"]
