"""A racing car on a course: LiDAR scan and odometry in, steering and speed out."""

import math

import slalom
from seeds import report, succeeded

REAR = 0.17145  # m, from the centre of gravity to the rear axle of the simulated car
course = slalom.Course("wren")


def drives_a_lap(method, seed, **options):
    """Whether the car drives a lap within 20 s without a collision."""
    planner = slalom.Planner(course, method, dict(
        horizon=14, samples=2000, temperature=3, input_min=-0.4189, input_max=0.4189, seed=seed, **options))
    world = slalom.World(course)
    world.reset(seed, [course.start])
    while world.time < 20 and world.observe()["laps"] < 1:
        seen = world.observe()
        x, y, yaw = seen["pose"]
        command = planner.update(
            seen["ranges"], angle_min=seen["angle_min"], angle_increment=seen["angle_increment"],
            range_max=seen["range_max"], pose=(x - REAR * math.cos(yaw), y - REAR * math.sin(yaw), yaw),
            speed=seen["speed"])
        for _ in range(5):  # 25 ms
            world.step([(command["steer"], command["speed"])])
            if world.observe()["contact"]:
                return False
    return world.observe()["laps"] == 1


mppi = succeeded(lambda seed: drives_a_lap("mppi", seed, variance=0.05))
svg_mppi = succeeded(lambda seed: drives_a_lap(
    "svg_mppi", seed, guide_step=0.005, guide_variance=0.01, gradient_variance=0.01, gradient_temperature=3,
    variance_min=0.001, variance_max=0.1))
report("a lap without collision", mppi, svg_mppi, 20)
