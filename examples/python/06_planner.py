"""A racing car on a course: LiDAR scan and odometry in, steering and speed out."""

import math

import slalom

REAR = 0.17145  # m, from the centre of gravity to the rear axle of the simulated car
course = slalom.Course("wren")
steer = 0.4189
options = dict(horizon=14, samples=2000, temperature=3, input_min=-steer, input_max=steer, guide_step=0.005,
               guide_variance=0.01, gradient_variance=0.01, gradient_temperature=3, variance_min=0.001,
               variance_max=0.1)
planner = slalom.Planner(course, "svg_mppi", options)
world = slalom.World(course)
world.reset(0, [course.start])
contact = False
while world.time < 20 and not contact and world.observe()["laps"] < 1:
    seen = world.observe()
    x, y, yaw = seen["pose"]
    command = planner.update(
        seen["ranges"], angle_min=seen["angle_min"], angle_increment=seen["angle_increment"],
        range_max=seen["range_max"], pose=(x - REAR * math.cos(yaw), y - REAR * math.sin(yaw), yaw),
        speed=seen["speed"])
    for _ in range(5):  # 25 ms
        world.step([(command["steer"], command["speed"])])
        contact = contact or world.observe()["contact"]
print(f"a lap in {world.time:.2f} s, contact: {contact}")
assert world.observe()["laps"] == 1 and not contact
