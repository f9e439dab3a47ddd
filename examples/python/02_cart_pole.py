"""A pole on a cart, one of the built-in problems: swing it up and keep the cart on its track."""

import numpy as np
import slalom
from seeds import report, succeeded

cart_pole = slalom.CartPole()


def stands(controller):
    """Whether the pole is upright 6 s after it started hanging down, and the cart never left its track."""
    x = np.array([0, 0, np.pi, 0])
    for _ in range(300):
        x = cart_pole.step(x, controller.solve(x, elapsed=cart_pole.dt).inputs[0])
        if abs(x[0]) > cart_pole.track:
            return False
    return np.cos(x[2]) > 0.99 and abs(x[3]) < 0.5


common = dict(horizon=60, samples=4096, temperature=0.1, input_min=-10, input_max=10)
mppi = succeeded(lambda seed: stands(slalom.Mppi(cart_pole, **common, variance=8, seed=seed)))
svg_mppi = succeeded(lambda seed: stands(slalom.SvgMppi(
    cart_pole, **common, guide_step=0.2, guide_variance=4, gradient_variance=2, gradient_temperature=0.1,
    variance_min=4, variance_max=8, seed=seed)))
report("the pole stands", mppi, svg_mppi, 20)
