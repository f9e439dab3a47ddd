"""An arm with seven joints reaches past a ball: over it, under it or behind it."""

import slalom
from seeds import report, succeeded

arm = slalom.Arm()


def arrives(controller):
    """Whether the hand comes within 5 cm of its goal within 8 s and no link collides with the ball or the ground."""
    x = arm.start
    for _ in range(160):
        x = arm.step(x, controller.solve(x, elapsed=arm.dt).inputs[0])
        if arm.collides(x):
            return False
        if arm.distance(x) < 0.05:
            return True
    return False


for temperature in 0.3, 1.0:  # the problem has bounds on its inputs and their rates
    common = dict(horizon=20, samples=1024, temperature=temperature)
    mppi = succeeded(lambda seed: arrives(slalom.Mppi(arm, **common, variance=0.5, seed=seed)))
    svg_mppi = succeeded(lambda seed: arrives(slalom.SvgMppi(
        arm, **common, guide_step=0.025, guide_variance=0.05, gradient_variance=0.05,
        gradient_temperature=temperature, variance_min=0.06, variance_max=0.25, seed=seed)))
    report(f"temperature {temperature:g}, the hand arrives", mppi, svg_mppi, 20, compare=True)
