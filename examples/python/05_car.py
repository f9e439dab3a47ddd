"""A car that steers and accelerates: pass parked cars on either side and stop at the line."""

import numpy as np
import slalom
from seeds import report, succeeded

car = slalom.Car()
PARKED = (25, 0.2), (50, -0.3)  # m, where the built-in problem has them


def hits(x):
    beside = any(abs(x[0] + 1.3 - px) < 4.5 and abs(x[1] - py) < 1.9 for px, py in PARKED)
    return beside or abs(x[1]) > car.half_road - 0.9


def arrives(controller):
    """Whether the car stands at the line after 20 s and had no collision."""
    x = np.array([0, 0, 0, 5.0])
    for _ in range(200):
        x = car.step(x, controller.solve(x, elapsed=car.dt).inputs[0])
        if hits(x):
            return False
    return abs(x[0] - car.stop_x) < 1 and x[3] < 0.5


for temperature in 0.3, 1.0:
    common = dict(horizon=30, samples=2048, temperature=temperature, input_min=[-0.5, -6], input_max=[0.5, 3])
    mppi = succeeded(lambda seed: arrives(slalom.Mppi(car, **common, variance=[0.1, 2], seed=seed)))
    svg_mppi = succeeded(lambda seed: arrives(slalom.SvgMppi(
        car, **common, guide_step=[0.025, 0.5], guide_variance=[0.05, 1], gradient_variance=[0.05, 1],
        gradient_temperature=0.3, variance_min=[0.02, 0.4], variance_max=[0.1, 2], seed=seed)))
    report(f"temperature {temperature:g}, the car stops at the line", mppi, svg_mppi, 19, compare=True)
