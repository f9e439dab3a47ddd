"""A pole on a cart is kept upright by ten plans a second and by feedback along them, while somebody pushes the cart."""

import numpy as np
import slalom
from seeds import SEEDS, succeeded


def stays_upright(seed, with_feedback):
    """Whether the pole stays within 0.5 rad for 10 s."""
    controller = slalom.Mppi(slalom.CartPole(), horizon=60, samples=2048, temperature=0.3, variance=4, input_min=-10,
                             input_max=10, seed=seed)
    feedback = slalom.Feedback(controller)
    cart = slalom.CartPole(dt=0.002)  # the real one, in short steps
    random = np.random.default_rng(seed)
    x = np.zeros(4)
    for _ in range(100):
        plan = controller.solve(x, elapsed=0.1)
        feedback.update(plan)
        planned = plan.inputs.copy()
        push = random.normal(0, 2)  # N
        for tick in range(50):
            u = feedback.input_at(tick * cart.dt, x) if with_feedback else planned[tick // 10]
            x = cart.step(x, u + push)
            if abs(x[2]) > 0.5:
                return False
    return True


plans = succeeded(lambda seed: stays_upright(seed, False))
feedback = succeeded(lambda seed: stays_upright(seed, True))
print(f"the pole stays upright: plans alone {plans} of {SEEDS} seeds, with feedback {feedback} of {SEEDS}")
assert feedback >= 0.9 * SEEDS and feedback > plans
